"""What a calculation costs, measured together with a known calculation in the same run."""
