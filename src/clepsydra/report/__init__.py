"""Figures, the process drawing and the HTML report."""
