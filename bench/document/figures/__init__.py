"""Figures of results, for the screen and for papers."""
