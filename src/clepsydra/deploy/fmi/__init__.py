"""Functional Mock-up Units of controllers and processes, with their C sources."""
