"""Robustness: how controllers do over many draws of what nobody knows exactly."""
