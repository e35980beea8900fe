"""The way back: from measured data to a model."""
