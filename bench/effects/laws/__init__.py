"""The laws of the catalogue's effects, one file each."""
