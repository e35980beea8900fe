"""Mamdani fuzzy control: sets, rules, inference, the file that holds them, and the step law."""
