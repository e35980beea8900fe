"""Polynomial digital control of eight equal liquid tanks in series, Bobál et al."""
