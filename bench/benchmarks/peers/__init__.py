"""The same problems solved by other programs, in a separate environment; see `make peers`."""
