"""A page on this machine that does what the commands do: the server, its guard, its work, and the page itself."""
