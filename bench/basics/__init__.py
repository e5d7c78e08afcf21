"""The base of all rooms: errors, files, progress, threads, wording, units, and two pieces of numerics."""
