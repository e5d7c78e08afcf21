"""The program's input: robots, payloads, recordings and datasets, read and checked."""
