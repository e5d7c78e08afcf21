"""Laws outside the catalogue, from a model's residual."""
