"""From the typed program to other planners and to the runtime."""
