"""Algorithms of linear algebra, as laws call them."""
