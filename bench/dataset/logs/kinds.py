"""What the files of logs end in."""

TEXTS = (".csv", ".tsv", ".txt", ".dat", ".log")
ARRAYS = (".mat", ".npz", ".parquet")
BAGS = (".mcap", ".db3", ".bag")
