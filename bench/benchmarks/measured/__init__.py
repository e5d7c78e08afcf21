"""`make measured`: results on measured logs, compared with known values of their machines (known.toml)."""
