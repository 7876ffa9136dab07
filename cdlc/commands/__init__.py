"""What each subcommand does: options to driver calls, output and an exit status (interface.md).

programs    check, compile, verify, fmt, import, explain
planning    plan, validate, simulate, engines
crosscheck  crosscheck
bench       bench
report      report
shared      exit statuses, diagnostics, what several of them need
"""
