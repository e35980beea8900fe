"""Draws of a robustness run, beside C++ by hand and JAX."""
