"""Pictures of programs and searches: a page for a search, a graph for a domain."""
