"""The step laws that run on the plant."""
