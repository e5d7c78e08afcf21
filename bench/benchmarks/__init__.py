"""Cost and accuracy of the bench: speed, measured machines, comparison with other programs."""
