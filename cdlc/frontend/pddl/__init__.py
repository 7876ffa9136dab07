"""PDDL, read and translated into CDL's syntax tree (lowering.md §3)."""
