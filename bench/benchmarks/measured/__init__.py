"""`make measured`: what comes out on measured logs, compared with known values of their machines (known.toml)."""
