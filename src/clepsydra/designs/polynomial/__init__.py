"""Sampled transfer functions and the polynomial methods that design for them."""
