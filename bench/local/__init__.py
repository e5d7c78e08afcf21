"""`bench open`: a local server and its page, from which the commands are run."""
