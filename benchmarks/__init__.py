"""Clepsydra measured beside a hand-written C++ program, JAX and python-control."""
