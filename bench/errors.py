"""The one exception that a user meets."""


class BenchError(Exception):
    """A mistake in what the user gave, told in one line that names the culprit.

    The command line prints the line without a traceback and exits with code 2.
    """
