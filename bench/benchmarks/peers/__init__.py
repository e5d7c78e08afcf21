"""The same problems, solved by others: in a separate environment, see `make peers`."""
