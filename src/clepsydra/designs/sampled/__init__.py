"""The process and its loops from one sample to the next, exact."""
