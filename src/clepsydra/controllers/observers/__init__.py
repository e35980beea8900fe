"""State observers: what a law knows of the process that no sensor shows."""
