"""From a liquid-tank process on paper to a proven controller in the PLC.

>>> import clepsydra as cl
>>> plant = cl.load("quadruple-tank")
>>> cl.analyse(plant).minimum_phase
True
"""

from clepsydra.base.lazy import published_names

__version__ = "0.1.0"

#: What is published is declared in __init__.pyi, with its types.
__getattr__, __dir__, __all__ = published_names(__name__, __file__)
