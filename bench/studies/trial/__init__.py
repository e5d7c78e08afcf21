"""Reliability of a diagnosis: machines with hidden effects, diagnosed without access to the truth."""
