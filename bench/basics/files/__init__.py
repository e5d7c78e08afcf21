"""Files: CSV text, tables, TOML, Python files, and atomic writing."""
