"""Scans in which a PLC does everything to a block, and what its status has to say of them."""

import numpy as np

from clepsydra.deploy.proof.scans import random_scans

#: Scans after which the block is a new one, with nothing kept, and those of all together.
LIFE, SCANS = 2500, 10_000
#: What a clock says that stopped, was set, wrapped, or was read after a breakpoint.
STEPS = (0.0, -1.0, np.nan, np.inf, -np.inf, 1e301, -4294967.3, 6.0, 600.0, 86400.0, 1e9)
NOT_NUMBERS = (np.inf, -np.inf, 1e301, -1e301)
ABSURD = (*NOT_NUMBERS, 0.0, -1.0, 1e9, 5e-324)
#: Bits of the status word.
INVALID_STEP, FAILED_SAFE, SCAN_LOST, INVALID_PARAMETER, STATE_LOST = (
    2**k for k in (6, 10, 15, 16, 17)
)


def strained_scans(program, seed, period):
    """Random scans, and in them clocks that jump or stand still, sensors that are good one scan in
    five, parameters that are none, limits the wrong way round, and lives that begin without state.
    """
    found = random_scans(program, SCANS, seed, period)
    random = np.random.default_rng(seed)
    step = found["time_step"]
    single = np.flatnonzero(random.random(SCANS) < 0.01)
    step[single] = random.choice(STEPS, len(single)) * random.choice([1.0, period], len(single))
    for stretch in _stretches(random, 12, 20):
        step[stretch] = random.choice(STEPS)
    for signal in program.inputs:
        if signal.part == "good":
            for stretch in _stretches(random, 8, 200):
                found[signal.name][stretch] = np.arange(SCANS)[stretch] % 5 == 0
    pairs = _pairs(program)
    ends = {end.name for pair in pairs for end in pair}
    for parameter in (p for p in program.parameters if p.kind != "boolean"):
        wrong = ABSURD if parameter.kind == "real" else (-1e9, -1.0, 0.0, 2e9)
        if parameter.name in ends:  # what is left of it is as designed, so that it is known
            found[parameter.name][:], wrong = parameter.initial, NOT_NUMBERS
        for stretch in _stretches(random, 3, 60):
            found[parameter.name][stretch] = random.choice(wrong)
    for low, high in pairs:
        for stretch in _stretches(random, 3, 60):
            found[low.name][stretch], found[high.name][stretch] = high.initial, low.initial
    found["start"][::LIFE] = 1.0
    found["start"][0] = 0.0
    return found


def lives(scans):
    """The scans of each block, which knows nothing of those before."""
    places = range(0, SCANS, LIFE)
    return [{name: column[k : k + LIFE] for name, column in scans.items()} for k in places]


def _stretches(random, count, longest):
    for begin in random.integers(SCANS, size=count):
        yield slice(begin, begin + int(random.integers(1, longest)))


def _pairs(program, first="low_limit", second="high_limit"):
    """The low and the high limit of each output, or other ends."""
    known = {parameter.name: parameter for parameter in program.parameters}
    lows = [p for p in program.parameters if p.part == first]
    return [(low, known[f"{low.owner}.{second}"]) for low in lows]


class Expected:
    """What follows from the inputs alone, computed by itself."""

    def __init__(self, program, scans):
        self.program, self.scans = program, scans
        self.fresh = np.arange(SCANS) % LIFE == 0
        start, acknowledge = scans["start"], scans["acknowledge"] > 0
        self.cold = (start == 2) & (self._before(start) != 2)
        self.warm = (start == 1) & (self._before(start) != 1)
        held = (self._before(acknowledge) > 0) & ~self.cold
        self.taken_back = (acknowledge & ~held) | self.cold | self.fresh
        step = scans["time_step"]
        with np.errstate(invalid="ignore"):
            valid = (step > 0) & (step <= 1e300)
            longest = self.in_force("longest_gap", kept=True)
            late = valid & (step > longest * self.in_force("sampling_period", kept=True))
        late &= ~(self.cold | self.warm | self.fresh)
        self.status = {
            INVALID_STEP: ~valid,
            SCAN_LOST: self._latched(late),
            INVALID_PARAMETER: self._invalid(),
            STATE_LOST: self._latched(self.warm & self.fresh),
        }

    def limits(self):
        """Each output with the limits that are ever valid."""
        ends = {low.owner: (low.initial, high.initial) for low, high in _pairs(self.program)}
        return [(s, *ends[s.owner]) for s in self.program.outputs if s.part == "out"]

    def in_force(self, name, *, kept=False):
        """The last valid value of a parameter; a cold start forgets it, if it is not kept."""
        (parameter,) = (p for p in self.program.parameters if p.name == name)
        given = self._given(parameter)
        valid = self._within(parameter, given)
        forgets = self.fresh if kept else self.fresh | self.cold
        found, value = [], parameter.initial
        for each, good, anew in zip(given, valid, forgets, strict=True):
            value = each if good else parameter.initial if anew else value
            found.append(value)
        return np.array(found)

    def _before(self, column):
        before = np.concatenate([[0], column[:-1]])
        return np.where(self.fresh, 0, before)

    def _latched(self, seen):
        found, state = [], False
        for now, back in zip(seen, self.taken_back, strict=True):
            state = now or (state and not back)
            found.append(state)
        return np.array(found)

    def _given(self, parameter):
        """The values of a parameter; not a number stands for the printed one."""
        given = self.scans[parameter.name]
        return np.where(np.isnan(given), parameter.initial, given)

    @staticmethod
    def _within(parameter, given):
        return (given >= parameter.low) & (given <= parameter.high) & (np.abs(given) <= 1e300)

    def _invalid(self):
        wrong = np.zeros(SCANS, dtype=bool)
        for parameter in self.program.parameters:
            if parameter.kind == "real" or (parameter.kind == "integer" and parameter.high <= 1e7):
                wrong |= ~self._within(parameter, self._given(parameter))
        for low, high in _pairs(self.program):
            wrong |= ~(self._given(low) < self._given(high))
        for low, high in _pairs(self.program, "range_low", "range_high"):
            wrong |= self._given(low) == self._given(high)
        return wrong
