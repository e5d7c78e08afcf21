"""What `import bench` gives to programs: the verbs of the command line, as functions from values to values."""
