"""One page in one file with the results of a run and the reasons for them: built from plain data, opened anywhere."""
