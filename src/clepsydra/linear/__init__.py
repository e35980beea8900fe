"""What the equations say near an operating point."""
