"""Linear regulators that were designed elsewhere."""
