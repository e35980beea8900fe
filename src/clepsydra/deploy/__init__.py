"""Structured Text and C, printed from the program that the engine runs."""
