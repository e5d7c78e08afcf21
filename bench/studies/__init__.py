"""Many runs: sweeps of scenarios, the accuracy's reference, and blind trials of the diagnosis."""
