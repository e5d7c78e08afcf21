"""Where a model fails: its current error by motor, against all possible variables, in words."""
