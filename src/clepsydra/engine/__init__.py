"""Programs to machine code, and the noise that they get."""
