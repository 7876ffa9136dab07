"""The CROW engine: programs run forward, and the search over their choices."""
