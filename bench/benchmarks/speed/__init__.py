"""What a calculation costs, measured beside something known in the same run."""
