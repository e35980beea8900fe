"""What a page makes of the engine's modules and of its noise, by hosts of Python."""

from clepsydra.engine.hosted_module import HostedModule
from clepsydra.engine.white_noise import white_noise


def hosted_module(content):
    """Return a module, by its bytes, that can be called."""
    return HostedModule(content)


def told_noise(noise):
    """Return the first sample of some noise, and the noise, of the numbers that tell of it."""
    seed = sum(word << 32 * place for place, word in enumerate(noise["seed"]))
    made = white_noise(seed, noise["stream"], noise["first"], noise["count"])
    return noise["first"], noise["deviation"] * made
