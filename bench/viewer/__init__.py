"""Recordings for the Rerun viewer: the moving robot, currents, errors, torques."""
