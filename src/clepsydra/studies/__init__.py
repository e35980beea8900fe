"""Controllers compared on one process."""
