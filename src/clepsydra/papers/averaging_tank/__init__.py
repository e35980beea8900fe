"""Kolankowski and Piotrowski 2022: an averaging tank with variable filling."""
