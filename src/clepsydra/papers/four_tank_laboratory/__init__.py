"""The audit of the four-tank laboratory report: its experiments, one a file."""
