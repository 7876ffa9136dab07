"""The CDL compiler: see ARCHITECTURE.md."""
