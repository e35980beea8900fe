"""Loop shaping: the most robust controller of a plant whose loop has been given its shape."""
