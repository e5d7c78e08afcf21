"""Filtering, differentiation and decimation of measured signals; automatic cut-offs."""
