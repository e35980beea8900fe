"""The work on one item of a proof: its scans and its runs, each made once."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import cached_property
from pathlib import Path

import numpy as np

from clepsydra.deploy.c99.printer import CSource
from clepsydra.deploy.compiler import Compiler
from clepsydra.deploy.printing.heading import digest
from clepsydra.deploy.process_program import process_program
from clepsydra.deploy.proof.compiled_c import CompiledC, printed_c
from clepsydra.deploy.proof.coverage import Coverage, coverage
from clepsydra.deploy.proof.engine_run import engine_run
from clepsydra.deploy.proof.instance import Array
from clepsydra.deploy.proof.item import ProofItem
from clepsydra.deploy.proof.scans import random_scans
from clepsydra.program.precision import in_single_arithmetic
from clepsydra.program.program import Program

#: Name of a printed file to what is in it.
Contents = Mapping[str, bytes]
_LENGTH = 16


class Job:
    """The runs of one item that its rows share.

    Parameters
    ----------
    item : ProofItem
        With a program.
    scans, seed : int
    folder : Path
        For what is built.
    compiler : Compiler
    """

    def __init__(
        self, item: ProofItem, scans: int, seed: int, folder: Path, compiler: Compiler
    ) -> None:
        self.item, self.scans, self.seed = item, scans, seed
        self.folder, self.compiler = folder, compiler

    @property
    def program(self) -> Program:
        """The program to be proved."""
        assert self.item.program is not None
        return self.item.program

    @cached_property
    def in_si(self) -> Job:
        """The work on the program with ports in SI: this one where it is that."""
        in_si = self.item.program_in_si
        if in_si is None or digest(in_si) == digest(self.program):
            return self
        item = replace(self.item, program=in_si)
        return Job(item, self.scans, self.seed, self.folder / "si", self.compiler)

    @cached_property
    def inputs(self) -> dict[str, Array]:
        """The scans."""
        item = self.item
        sound = item.kind == "process"
        period = item.sampling_period
        return random_scans(self.program, self.scans, self.seed, period, broken=not sound)

    @cached_property
    def single_inputs(self) -> dict[str, Array]:
        """The scans in single precision, as doubles."""
        with np.errstate(all="ignore"):
            return {
                name: values.astype(np.float32).astype(float)
                if np.asarray(values).dtype.kind == "f"
                else values
                for name, values in self.inputs.items()
            }

    @cached_property
    def engine(self) -> Array:
        """The engine over the scans: outputs and states [scans, q + n]."""
        return engine_run(self.program, self.inputs)

    @cached_property
    def engine_unfused(self) -> Array:
        """The engine with no multiply-add fused, over the scans."""
        return engine_run(self.program, self.inputs, fuse=False)

    @cached_property
    def engine_of_single(self) -> Array:
        """The engine, in double precision, over the scans in single precision."""
        return engine_run(self.program, self.single_inputs)

    @cached_property
    def engine_in_single(self) -> Array:
        """The engine, with every operation rounded to single precision, over these scans."""
        return engine_run(in_single_arithmetic(self.program), self.single_inputs)

    @cached_property
    def single_c(self) -> CompiledC:
        """The C in single precision."""
        return CompiledC(
            self.program, self.folder / "single", "single", self.compiler, self.printed_single_c
        )

    @cached_property
    def printed_single_c(self) -> CSource:
        """The printed C in single precision."""
        return printed_c(self.program, "single", self.item.origin)

    @cached_property
    def run_of_single_c(self) -> Array:
        """The C in single precision over the scans."""
        self.single_c.initialise()
        return self.single_c.run(self.single_inputs)

    @cached_property
    def setting(self) -> str:
        """Digest of the scans, of the engine's run over them, and of the time between them."""
        period = np.array([self.item.sampling_period])
        tables = {**self.inputs, " engine": self.engine, " period": period}
        return _digest(
            part
            for name in sorted(tables)
            for part in (name.encode(), repr(tables[name].shape).encode(), _bytes(tables[name]))
        )

    @cached_property
    def loop(self) -> str:
        """Digest of the loop that the scores are of; empty where there is none.

        Of the controller its wires and where it starts, of the process its program and where it
        rests, and the scenario; the controller's own program has a digest of its own.
        """
        item = self.item
        controller, point, scenario = item.controller, item.point, item.scenario
        if controller is None or point is None:
            return ""
        said = [
            controller.input_wires, controller.output_wires, controller.initial_state,
            controller.values, controller.free_inputs, point.as_dict(),
            digest(process_program(point)),
        ]  # fmt: skip
        parts = [repr(each).encode() for each in said]
        if scenario is not None:
            parts.append(
                repr((scenario.sampling_period, scenario.segments, scenario.seed)).encode()
            )
            if scenario.begin is not None:
                parts.append(repr(scenario.begin.as_dict()).encode())
            parts += [
                part
                for table in (scenario.setpoints, scenario.disturbances, scenario.noise)
                for part in (repr(np.shape(table)).encode(), _bytes(table))
            ]
        return _digest(parts)

    @cached_property
    def coverage(self) -> Coverage:
        """What the scans exercise in the engine."""
        return coverage(self.program, self.engine)


def contents_digest(contents: Contents) -> str:
    """Return a digest of files, names included."""
    return _digest(part for name in sorted(contents) for part in (name.encode(), contents[name]))


def _bytes(table: np.ndarray) -> bytes:
    return np.ascontiguousarray(table, dtype=float).tobytes()


def _digest(parts: Iterable[bytes]) -> str:
    whole = hashlib.sha256()
    for part in parts:
        whole.update(len(part).to_bytes(8, "little"))
        whole.update(part)
    return whole.hexdigest()[:_LENGTH]
