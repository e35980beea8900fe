"""The proof that printed code equals the simulation, and the tools that run printed code."""
