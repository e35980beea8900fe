"""Tuning by simulation: parameters of a step law found on the process's own equations."""
