"""Nagammai and Latha 2016: three coupled tanks."""
