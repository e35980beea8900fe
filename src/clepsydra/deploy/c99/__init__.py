"""C99 of a step program."""
