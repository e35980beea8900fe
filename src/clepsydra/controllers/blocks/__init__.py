"""Blocks that the step laws share: limits, anti-windup, modes, validity, status."""
