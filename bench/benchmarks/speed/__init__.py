"""Cost of calculations, mostly relative to a reference calculation measured in the same run."""
