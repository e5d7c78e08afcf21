"""The experiment to plan before there are data: motions inside all limits, and their information."""
