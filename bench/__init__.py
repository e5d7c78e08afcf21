"""Drive gains and dynamic parameters of parallel robots from joint positions and current references."""
