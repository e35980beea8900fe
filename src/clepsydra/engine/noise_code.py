"""Prints the function that makes white, normal noise for the lanes of a kernel, chunk by chunk."""

from __future__ import annotations

from collections.abc import Callable
from math import gcd

from clepsydra.engine.kernel_form import KernelForm
from clepsydra.engine.lane_function import LaneFunction
from clepsydra.engine.vector_philox import PhiloxPrinter
from clepsydra.engine.vector_quantile import QuantilePrinter

NOISE = "clepsydra_noise"
#: Samples of a chunk: with four inputs and eight lanes it leaves half of a first cache to others.
CHUNK = 64
#: Whole numbers of one input in a plan: stream, first sample, the one after the last, deviation.
OF_AN_INPUT = 4
#: Vectors that are made side by side: one alone has to wait for itself.
_SIDE_BY_SIDE = 4
#: What functions are given beside where they write to.
_OF_STRETCH = "i64 %begun, i64 %to"
_OF_SHARES = f"{_OF_STRETCH}, i64 %stream, ptr noalias %plan, ptr noalias %numbers"
_OF_DEVIATES = f"{_OF_STRETCH}, double %deviation"
_OF_NOISE = "ptr noalias %plan, ptr noalias %numbers, i64 %inputs, i64 %sample, i64 %count"


def noise_code(form: KernelForm) -> str:
    """Return LLVM code of a function that makes the noise of a chunk for a group of lanes.

    The function has the C signature ::

        void clepsydra_noise(double *made, const int64_t *plan, const int64_t *numbers,
                             int64_t inputs, int64_t sample, int64_t count)

    with `made` [inputs, CHUNK, lanes], where sample k stands in row k mod CHUNK; the plan, which
    is the lower word of all seeds and then [inputs, OF_AN_INPUT], the deviation by its bits; and
    the upper words of the seeds [lanes]. It makes samples up to the end of the chunk at most;
    where an input has no noise stands −0, which changes no number that it is added to.

    Every bit is that of `white_noise.white_noise` times the deviation.
    """
    return _NoisePrinter(form).code()


class _NoisePrinter:
    """Prints the function, and three that go through the samples of a chunk.

    What one of them keeps in registers does not go through the others.
    """

    def __init__(self, form: KernelForm) -> None:
        self.form, self.lanes = form, form.lanes
        self.width = gcd(form.lanes, form.processor.lanes if form.processor else 2)
        self.vectors = range(0, form.lanes, self.width)
        #: Rows of so many vectors that are made together.
        self.rows = max(_SIDE_BY_SIDE // len(self.vectors), 1)
        self.text = LaneFunction(self.width)

    def code(self) -> str:
        functions = [
            self._function("internal void @quiet", _OF_STRETCH, self._quiet),
            self._function("internal void @shares", _OF_SHARES, self._shares),
            self._function("internal void @deviates", _OF_DEVIATES, self._deviates),
            self._function(f"void @{NOISE}", _OF_NOISE, self._inputs),
        ]
        attributes = f"attributes #0 = {{ {self.form.attributes} }}"
        return "\n".join([QuantilePrinter.table(), *functions, attributes, ""])

    def _function(self, head: str, given: str, body: Callable[[], None]) -> str:
        self.text = LaneFunction(self.width)
        self.text.begin("entry")
        body()
        self.text.line("ret void")
        first = f"define {head}(ptr noalias %made, {given}) noinline #0 {{"
        return "\n".join([first, *self.text.lines, "}"])

    def _inputs(self) -> None:
        """Print the loop over inputs: noise within their stretch, none before and after it."""
        text = self.text
        text.line("%after = add i64 %sample, %count")
        text.line("br label %head")
        text.begin("head")
        text.line("%input = phi i64 [ 0, %entry ], [ %input.next, %end ]")
        text.line("%more = icmp slt i64 %input, %inputs")
        text.line("br i1 %more, label %body, label %done")
        text.begin("body")
        offset = text.assign(f"mul i64 %input, {OF_AN_INPUT}")
        plan = text.assign(f"getelementptr i64, ptr %plan, i64 {offset}")
        stream, first, last = (self._of_plan("i64", plan, index) for index in (1, 2, 3))
        deviation = self._of_plan("double", plan, OF_AN_INPUT)
        offset = text.assign(f"mul i64 %input, {CHUNK * self.lanes}")
        made = text.assign(f"getelementptr double, ptr %made, i64 {offset}")
        begun, ended = self._within(first), self._within(last)
        noisy = text.assign(f"icmp slt i64 {begun}, {ended}")
        text.line(f"br i1 {noisy}, label %noisy, label %quiet")
        text.begin("noisy")
        stretch = f"ptr {made}, i64 {begun}, i64 {ended}"
        text.line(f"call void @shares({stretch}, i64 {stream}, ptr %plan, ptr %numbers)")
        text.line(f"call void @deviates({stretch}, double {deviation})")
        text.line("br label %quiet")
        text.begin("quiet")
        # What is made together goes beyond its stretch, so silence comes last.
        text.line(f"call void @quiet(ptr {made}, i64 %sample, i64 {begun})")
        text.line(f"call void @quiet(ptr {made}, i64 {ended}, i64 %after)")
        text.line("br label %end")
        text.begin("end")
        text.line("%input.next = add i64 %input, 1")
        text.line("br label %head")
        text.begin("done")

    def _within(self, sample: str) -> str:
        """Print the sample of the chunk, or the one after it, that is the nearest to one."""
        text = self.text
        for predicate, bound in ("slt", "%sample"), ("sgt", "%after"):
            beyond = text.assign(f"icmp {predicate} i64 {sample}, {bound}")
            sample = text.assign(f"select i1 {beyond}, i64 {bound}, i64 {sample}")
        return sample

    def _of_plan(self, kind: str, plan: str, index: int) -> str:
        place = self.text.assign(f"getelementptr i64, ptr {plan}, i64 {index}")
        return self.text.assign(f"load {kind}, ptr {place}, align 8")

    def _loop(self, rows: int, body: Callable[[list[str]], None]) -> None:
        """Print a loop over samples, some rows of the chunk at a time."""
        text = self.text
        text.line(f"%from = and i64 %begun, {-rows}")
        text.line("br label %head")
        text.begin("head")
        text.line("%at = phi i64 [ %from, %entry ], [ %at.next, %body ]")
        text.line("%more = icmp slt i64 %at, %to")
        text.line("br i1 %more, label %body, label %done")
        text.begin("body")
        row = text.assign(f"and i64 %at, {CHUNK - 1}")
        row = text.row("%made", row, len(self.vectors))
        body(
            [
                text.assign(f"getelementptr double, ptr {row}, i64 {k * self.width}")
                for k in range(rows * len(self.vectors))
            ]
        )
        text.line(f"%at.next = add i64 %at, {rows}")
        text.line("br label %head")
        text.begin("done")

    def _quiet(self) -> None:
        """Print what stands where there is no noise."""

        def rows(places: list[str]) -> None:
            for place in places:
                self.text.store(self.text.literal(-0.0), place)

        self._loop(1, rows)

    def _shares(self) -> None:
        """Print the shares of which deviates are made, two samples of a block at once."""
        text, vectors = self.text, len(self.vectors)
        lower = text.assign("load i64, ptr %plan, align 8")
        places = [text.row("%numbers", str(k), 1) for k in range(vectors)]
        uppers = [text.assign(f"load {text.whole}, ptr {place}, align 8") for place in places]
        philox = PhiloxPrinter(text, lower, uppers)

        def rows(places: list[str]) -> None:
            first = text.assign("lshr i64 %at, 1")
            blocks = [text.assign(f"add i64 {first}, {k}") for k in range(self.rows)]
            units = [(block, k) for block in blocks for k in range(vectors)]
            for low in range(0, len(units), _SIDE_BY_SIDE):
                some = range(low, min(low + _SIDE_BY_SIDE, len(units)))
                for k, words in zip(
                    some, philox.words([units[k] for k in some], "%stream"), strict=True
                ):
                    row, vector = divmod(k, vectors)
                    for sample in (0, 1):
                        share = QuantilePrinter.share(text, *words[2 * sample : 2 * sample + 2])
                        text.store(share, places[(2 * row + sample) * vectors + vector])

        self._loop(2 * self.rows, rows)

    def _deviates(self) -> None:
        """Print the noise of samples, in the place of their shares."""
        text, quantile = self.text, QuantilePrinter(self.text)
        deviation = text.spread("double", "%deviation")

        def rows(places: list[str]) -> None:
            for low in range(0, len(places), _SIDE_BY_SIDE):
                some = places[low : low + _SIDE_BY_SIDE]
                for place, deviate in zip(some, quantile.deviates(some), strict=True):
                    text.store(text.multiply(deviate, deviation), place)

        self._loop(self.rows, rows)
