"""The step program: what happens in a sample, read from CasADi expressions."""
