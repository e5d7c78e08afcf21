"""One simulated experiment, and its trajectories."""
