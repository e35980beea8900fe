"""One package a document: its experiments, its printed numbers, and the audit."""
