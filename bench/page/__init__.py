"""One page in one file that says what a run found and shows why: built from plain data, opened anywhere."""
