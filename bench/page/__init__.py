"""Reports: the results of a run and the evidence for them on one page, a self-contained file made from plain data."""
