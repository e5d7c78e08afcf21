"""The effects of the simulated machine, one file each."""
