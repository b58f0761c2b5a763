"""What stops a measurement."""


class BenchError(Exception):
    """The bench cannot go on; the text is one line for the person who started it."""
