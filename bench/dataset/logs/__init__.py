"""Turn logs of other programs into recordings: read, map columns, convert to SI, cut at gaps, check."""
