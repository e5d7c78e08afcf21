"""How far a diagnosis can be trusted: machines with hidden effects, diagnosed without access to the truth."""
