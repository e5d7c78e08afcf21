"""Where a model fails: the error of its currents by motor, against all that it may depend on, in words."""
