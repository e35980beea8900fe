"""What a run was worth, one score a function."""
