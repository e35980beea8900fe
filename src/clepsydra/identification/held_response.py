"""The exact response of a linear system to an input that is held between samples."""

from __future__ import annotations

import numpy as np


class HeldResponse:
    """Responses to one input, for any system that is given by its step response.

    With u held from sample to sample, y(kT) = Σ Δu(j) S(kT − jT − θ): a convolution of the
    changes of u with the step response S, read off between the samples where the dead time θ is
    no multiple of T. Nothing is approximated. Before the record u stood at its first value.

    Parameters
    ----------
    signal : ndarray [N]
        u

    Examples
    --------
    A lag of one sample and a gain of one, half a sample late:

    >>> held = HeldResponse(np.array([0.0, 0.0, 1.0, 1.0]))
    >>> since = np.maximum(np.arange(4) - 0.5, 0.0)
    >>> abs(held.to((1 - np.exp(-since))[:, None]).ravel()).round(6)
    array([0.      , 0.      , 0.      , 0.393469])
    """

    def __init__(self, signal: np.ndarray) -> None:
        from scipy.fft import next_fast_len, rfft

        self.samples = len(signal)
        self._length = next_fast_len(2 * self.samples, real=True)
        changes = np.diff(signal, prepend=signal[0])
        self._spectrum = rfft(changes, self._length)[:, None]

    def to(self, kernels: np.ndarray) -> np.ndarray:
        """Return the outputs [N, m] of systems with given step responses [N, m]."""
        from scipy.fft import irfft, rfft

        spectrum = rfft(kernels, self._length, axis=0) * self._spectrum
        return np.asarray(irfft(spectrum, self._length, axis=0)[: self.samples])
