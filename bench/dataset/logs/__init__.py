"""Logs of other programs become recordings: read, named, turned into SI, cut at gaps, checked."""
