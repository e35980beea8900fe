"""Study files: what a study compares, written by a user."""
