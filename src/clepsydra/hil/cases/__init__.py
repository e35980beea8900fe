"""The cases that a loop on its wires has to take."""
