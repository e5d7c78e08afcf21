"""The workbench of a report: tick effects in the page, and see what `bench identify --with` would find."""
