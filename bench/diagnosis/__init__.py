"""Which physical effect a model lacks: evidence on recordings that were not fitted, and its wording."""
