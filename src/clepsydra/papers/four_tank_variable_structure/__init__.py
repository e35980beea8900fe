"""Four tanks with input constraint under variable-structure PID, document 002."""
