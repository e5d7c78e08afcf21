"""One experiment to simulate, and the trajectories that it runs."""
