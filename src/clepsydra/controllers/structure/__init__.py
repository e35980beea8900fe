"""Blocks of a loop structure, joined to one step law."""
