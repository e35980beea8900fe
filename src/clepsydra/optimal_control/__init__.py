"""Optimal control of a process as a nonlinear programme: smooth equations, collocated in blocks."""
