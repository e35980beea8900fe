"""On a busy machine: what comes late of the bench itself is not laid at the loop's door."""

from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import pytest
from plc_bench import PlcBench
from table_bus import BusFault, TableBus

from clepsydra.hil import hardware_in_the_loop as trials
from clepsydra.hil.case import Case, Verdict
from clepsydra.hil.hardware_in_the_loop import Asked
from clepsydra.hil.trial import Timing, _through
from clepsydra.hil.wire_check import check_wires


class UnansweringBus(TableBus):
    """A bus on which writes arrive and their answers do not while `mute` is set."""

    mute = False

    async def write(self, values) -> None:
        await super().write(values)
        if self.mute:
            raise BusFault("process image", "", "no answer", answered=False)


def test_a_write_without_an_answer_is_one_that_may_have_come(compiled_c, tmp_path):
    bench = PlcBench(compiled_c, tmp_path, UnansweringBus)
    bench.scan(5)
    bench.write("level_1.sp", 7.0)
    bench.bus.mute = True
    bench.scan(3)
    bench.bus.mute = False
    bench.scan(5)
    checked = bench.settings, bench.log, bench.wiring, bench.rows, bench.tags
    found = check_wires(*checked)
    assert bench.log.lost == (0, 3)
    assert (found.foreign, found.late) == (0, 6)


class JumpyRig:
    """A rig that is looked at after as many samples as it is told, and then at each."""

    def __init__(self, jumps) -> None:
        self.sample, self.jumps = 0, iter(jumps)
        self.table = self.instructor = None
        self.image = SimpleNamespace(published=lambda: SimpleNamespace(sample=self.sample))
        self.settings = SimpleNamespace(process=SimpleNamespace(sampling_period=1.0), speed=20.0)

    def watch(self, pause) -> tuple[()]:
        self.sample += next(self.jumps, 1)
        return ()


def gone_through(jumps) -> tuple[list[int], tuple[int, int]]:
    """When something was done, and the samples that the case is judged by."""
    rig, done = JumpyRig(jumps), []

    def act(hands) -> None:
        done.append(rig.sample)

    case = Case(1, "two acts", True, lambda s: {2: act, 8: act}, lambda s: 20, lambda e: None)
    rows, plc = SimpleNamespace(take=lambda image: None), SimpleNamespace(send=None)
    return done, _through(rig, plc, rows, None, {"two acts": case})["two acts"]


def test_a_case_whose_hands_come_late_is_gone_through_again():
    assert gone_through([]) == ([12, 18], (10, 30))
    # Both acts at once, since nobody looked meanwhile: nothing that a loop could have seen.
    done, window = gone_through([30])
    assert done == [30, 30, 32, 38] and window == (30, 50)
    # Two samples late is what each case stands.
    assert gone_through([14]) == ([14, 18], (10, 30))


@dataclass(frozen=True)
class Settings:
    """As much of a rig's settings as is asked for before a trial."""

    folder: Path
    process = SimpleNamespace(title="Tank")
    tags = ()


@pytest.mark.parametrize(
    ("amiss", "asked", "periods"),
    [
        (10, Asked(("c",), ("modbus",)), [0.02, 0.05]),
        (0, Asked(("c",), ("modbus",)), [0.02]),
        (10, Asked(("c",), ("modbus",), period=0.02), [0.02]),
    ],
)
def test_what_fails_at_a_speed_that_was_not_held_is_tried_slower(
    monkeypatch, tmp_path, amiss, asked, periods
):
    """Unless the speed was asked for, or the machine held it: then the loop has failed."""
    tried = []

    def trial(settings, ready, asked, image, wires, period, cases):
        tried.append(period)
        late = amiss if period < 0.05 else 0
        timing = Timing(period, (0.0, 0.0, 0.0), late, 0, 100)
        return SimpleNamespace(
            holds=period >= 0.05, timing=timing, verdicts={"": Verdict(True, "")}
        )

    monkeypatch.setattr(trials, "_trial", trial)
    monkeypatch.setattr(trials, "_fastest", lambda *_: 0.02)
    monkeypatch.setattr(trials, "check_units", lambda *_: None)
    monkeypatch.setitem(trials.PLCS, "c", lambda *_: SimpleNamespace(title="C", label="C"))
    ready = SimpleNamespace(controller=SimpleNamespace(title="PI"))
    settings = Settings(tmp_path)
    said: list[str] = []
    found = trials.hardware_in_the_loop(settings, ready, asked, said.append)
    assert tried == periods
    assert found.holds == (periods[-1] == 0.05)
    assert any("too fast" in words for words in said) == (len(periods) > 1)
