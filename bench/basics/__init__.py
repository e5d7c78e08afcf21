"""What every room stands on: errors that users meet, progress, threads, and two pieces of numerics."""
