"""Lessons: what a reader of a laboratory is asked to do, as files."""
