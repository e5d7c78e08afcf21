"""`make measured`: what comes out on measured logs, beside what is known of their machines (known.toml)."""
