"""The functions of `import bench`: the commands' operations as functions from values to values."""
