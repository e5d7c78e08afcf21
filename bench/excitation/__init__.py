"""Exciting trajectories, designed with the identification model (Gautier and Khalil 1992)."""
