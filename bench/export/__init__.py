"""Use an identified model elsewhere: a physical parameter set, MJCF, URDF, tables, a feed-forward."""
