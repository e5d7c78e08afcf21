"""What comes in: robots, payloads, recordings and datasets, read and checked."""
