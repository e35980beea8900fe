"""Exported code: its time beside the engine's, and its size."""
