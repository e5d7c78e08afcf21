"""Cost and accuracy of this program: speed, measured machines, evaluation, comparison with other programs."""
