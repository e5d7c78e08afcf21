"""The base of all rooms: errors that users meet, progress, threads, and two pieces of numerics."""
