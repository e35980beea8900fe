"""Structured Text, parsed by a public grammar and run: a reader independent of the printer."""
