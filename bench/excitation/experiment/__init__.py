"""The experiment to make before there is any data: motions inside all limits, and what they will tell."""
