"""The cases of hardware in the loop: each holds without a clock, and says where a loop fails it."""

from dataclasses import replace

import numpy as np
import pytest
from plc_bench import READY, FailingBus, PlcBench

from clepsydra.hil.case import CASES, Episode, Hands, Subject
from clepsydra.hil.commands import Delay, PowerCycle, Skip, Stop
from clepsydra.rig.instructor import Instructor
from clepsydra.rig.tag import WIRE_LOSS

#: Samples of silence after which the bench's rig has had enough, and of a period of its own clock.
SILENCE, PERIOD = 10, 1.0


class Loop(PlcBench):
    """A PLC and its rig, gone through sample by sample, with what may be done to both."""

    def __init__(self, image, folder) -> None:
        super().__init__(image, folder, FailingBus)
        self.hands = Hands(self.table, Instructor(self.process, self.image), self.commanded)
        at = READY.point.as_dict()
        level, pump = self.process.signal("level_1"), self.process.signal("pump_1")
        self.subject = Subject(
            self.process, replace(level, initial=at["level_1"]),
            replace(pump, initial=at["pump_1"]), self.settings.fail_safe, PERIOD, SILENCE, 4.0,
        )  # fmt: skip
        self.quiet, self.step_in = 0, [1.0]
        self.silent_for = 0
        self.random = np.random.default_rng(1)

    def commanded(self, command) -> None:
        match command:
            case Stop():
                self.quiet = round(command.seconds)
            case PowerCycle():
                self.quiet = round(command.seconds)
                self.power_cycle(retained=command.retained)
            case Skip():
                self.quiet = command.scans
            case Delay():
                self.step_in = [1.0 + command.seconds] + [1.0] * (command.scans - 1)
                self.step_in += [1.0 - command.seconds]

    def sample(self) -> None:
        if self.quiet:
            self.quiet -= 1
            self.silent_for += 1
            self.step(heard=self.silent_for <= SILENCE)
            return
        time_step = self.silent_for + (self.step_in.pop(0) if self.step_in else 1.0)
        self.silent_for = 0
        self.bus.fails = self.random.random() < self.image.read(WIRE_LOSS)
        self.scan(time_step=time_step)

    def through(self, name) -> Episode:
        case, first = CASES[name], self.plant.sample
        acts, last = dict(case.acts(self.subject)), first + case.samples(self.subject)
        for at in range(first, last):
            acts.get(at - first, lambda hands: None)(self.hands)
            self.sample()
        self.rows.take(self.image)
        return Episode(self.subject, self.rows, self.log, first, last)


@pytest.mark.parametrize("name", list(CASES))
def test_each_holds_without_a_clock(compiled_c, tmp_path, name):
    loop = Loop(compiled_c, tmp_path)
    loop.scan(10)
    episode = loop.through(name)
    verdict = CASES[name].judge(episode)
    assert verdict.holds, verdict.words


@pytest.mark.parametrize("name", list(CASES))
def test_each_fails_where_nothing_of_it_comes_about(compiled_c, tmp_path, name):
    """A loop that is left alone shows nothing that a case asks for."""
    loop = Loop(compiled_c, tmp_path)
    loop.scan(10 + CASES[name].samples(loop.subject))
    last = 10 + CASES[name].samples(loop.subject)
    verdict = CASES[name].judge(Episode(loop.subject, loop.rows, loop.log, 10, last))
    assert not verdict.holds, verdict.words
