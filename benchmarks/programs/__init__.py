"""Quadratic programs as a predictive controller solves them, beside other solvers."""
