"""How good control could possibly be: the least error that any input within its limits reaches."""
