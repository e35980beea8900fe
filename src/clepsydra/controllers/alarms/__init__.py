"""Alarms as blocks: what each watches for, how it is timed and acknowledged, and their law."""
