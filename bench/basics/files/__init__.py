"""Files: CSV, tables, controllers' logs, TOML, and writing that is whole or not at all."""
