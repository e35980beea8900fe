"""Drawings: a process with its control loops, and the blocks of a controller."""
