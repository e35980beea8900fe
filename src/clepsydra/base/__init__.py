"""Units, errors and signals."""
