"""How long a study, and an installation, keep the processor busy, beside an earlier commit."""
