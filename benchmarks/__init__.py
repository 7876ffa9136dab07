"""What cdlc costs, measured: `python -m benchmarks [name ...] [--quick]`."""
