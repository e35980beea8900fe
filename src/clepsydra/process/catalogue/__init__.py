"""Processes as files that a user could have written."""
