"""What every printer of a program shares: expressions, names, comments and checks."""
