"""Sweeps: many runs of scenarios, with truth and identification compared in a table."""
