"""CDL in editors and on pages: what colours it. Nothing else in the package imports this."""
