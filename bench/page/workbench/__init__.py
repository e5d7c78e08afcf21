"""The workbench of a report: select effects on the page, and see what `bench identify --with` would give."""
