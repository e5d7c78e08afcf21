"""The same problems, solved by others: in an environment of its own, see `make peers`."""
