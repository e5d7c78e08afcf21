"""What the bench costs and how right it is beside what others know: speed, measured machines, other programs."""
