"""An element: one part of a plant, with its equation."""
