"""Passes: functions from programs to programs that mean the same, a verb a file."""
