"""What is controlled: elements joined to one set of equations."""
