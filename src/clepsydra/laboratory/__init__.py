"""The laboratory: a process under its controllers, moved by hand in a page, and run again here."""
