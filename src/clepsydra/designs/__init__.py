"""A controller's parameters from a linear model, one method a file."""
