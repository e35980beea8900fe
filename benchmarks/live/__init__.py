"""How long a report takes from a slider to the curves."""
