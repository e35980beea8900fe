"""From a liquid-tank process on paper to a proven controller in the PLC."""

__version__ = "0.1.0"
