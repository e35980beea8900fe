"""A search that is interrupted ends at once, and what raised it is heard."""

import signal

import pytest

import clepsydra as cl
from clepsydra.optimal_control.interruptible import Interruption


@pytest.fixture
def heard():
    """Let SIGINT be heard, which who starts the tests in the background ignores."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("heard")
def test_a_signal_ends_the_search_at_its_next_iteration(monkeypatch):
    """As by control-C while the solver runs, which would swallow it."""
    asked = []

    def sent(self, results):
        asked.append(1)
        if len(asked) == 3:
            signal.raise_signal(signal.SIGINT)
        return [int(self._arrived is not None)]

    monkeypatch.setattr(Interruption, "eval", sent)
    with pytest.raises(KeyboardInterrupt):
        cl.limit("three-tanks", [cl.step("level_3", "+1 cm", at="1 min")])
    assert len(asked) == 3
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
