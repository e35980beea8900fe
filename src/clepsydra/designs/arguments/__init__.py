"""What the arguments of designs are and how they are read: words, units, bounds, choices."""
