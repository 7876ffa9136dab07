"""The CROW planner: plans with compiled CDL programs and imports nothing of `cdlc`."""
