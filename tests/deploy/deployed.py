"""Printed programs made to run, by the package's own proof: C compiled, text interpreted."""

import math
import re
import struct
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from tools import need_compiler, need_grammar

from clepsydra.deploy import compiler
from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.proof import compiled_c, interpreted_text
from clepsydra.deploy.proof.engine_run import engine_run
from clepsydra.deploy.structured_text.printer import print_structured_text
from clepsydra.deploy.target import target_of
from clepsydra.program.program import Program

STRICT = list(compiler.STRICT)


def bits(value: float) -> int:
    """The bits of a number; every not-a-number counts as the same one."""
    return -1 if math.isnan(value) else struct.unpack("<Q", struct.pack("<d", value))[0]


def all_bits(values: np.ndarray) -> np.ndarray:
    values = np.ascontiguousarray(values, dtype=float)
    return np.where(np.isnan(values), -1, values.view(np.int64))


def files_of(ready, to, **options):
    """The files of an export, name to content."""
    target, chosen = target_of(to, options)
    return target.controller(SimpleNamespace(ready=ready), chosen).files


class CompiledC(compiled_c.CompiledC):
    """The C of a program, built by the system's compiler under `STRICT`."""

    def __init__(self, program: Program, folder: Path, precision: str = "double") -> None:
        need_compiler()
        strict = replace(compiler.find_compiler("tests"), flags=tuple(STRICT))
        super().__init__(program, folder, precision, strict)

    def __call__(self, inputs: dict[str, float]) -> list[float]:
        """Run one scan and return the outputs in order."""
        columns = {name: np.array([value]) for name, value in inputs.items()}
        (row,) = self.run(columns or {"nothing": np.zeros(1)})
        return row[: len(self.program.outputs)].tolist()

    def state(self) -> list[float]:
        """Return the state in order; of a delay ring the value that the next scan reads."""
        memory = np.frombuffer(bytes(self.memory), dtype=np.dtype(type(self.memory)))
        return [float(column[0]) for column in self._states(memory, follow=True)]


class InterpretedText(interpreted_text.InterpretedText):
    """The Structured Text of a program, where the grammar is installed."""

    def __init__(
        self, program: Program, precision: str = "double", dialect: str = "codesys"
    ) -> None:
        need_grammar()
        super().__init__(program, precision, dialect)


def run_both(
    program: Program, folder: Path, inputs: dict[str, np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Run C and text over all samples; returns outputs and states of each [samples, q + n]."""
    return CompiledC(program, folder).run(inputs), InterpretedText(program).run(inputs)


def run_alike(program: Program, folder: Path, inputs: dict[str, np.ndarray]) -> np.ndarray:
    """Run engine, C and text, which agree in every bit; returns what they found."""
    engine = engine_run(program, inputs)
    in_c, in_text = run_both(program, folder, inputs)
    assert np.isfinite(engine).all()
    assert np.array_equal(all_bits(engine), all_bits(in_c))
    assert np.array_equal(all_bits(engine), all_bits(in_text))
    return engine


def no_output_lay_idle(
    program: Program, engine: np.ndarray, bits: tuple[int, ...], least: int = 0
) -> None:
    """See that each bit of a status was set and clear, and others had more than so many values."""
    for column, output in enumerate(program.outputs):
        if output.part == "status":
            word = engine[:, column].astype(int)
            for bit in bits:
                assert np.any(word & bit) and not np.all(word & bit), (output, bit)
        elif least:
            assert len(np.unique(engine[:, column])) > least, output


def prints_its_numbers(controller) -> None:
    """See that C and text have the values of a controller as they are."""
    program = controller.program()
    in_c = print_c(program).source
    in_text = print_structured_text(program).split("FUNCTION_BLOCK ")[-1]
    for entry, value in controller.values.items():
        for printed, pattern in ((in_c, rf"->{entry} = "), (in_text, rf"  {entry} : LREAL := ")):
            found = re.search(pattern + r"([-+.\dE]+);", printed)
            assert found is not None and float(found[1]) == float(value), entry


def spoilt(random: np.random.Generator, values: np.ndarray, share: float) -> np.ndarray:
    """Replace a share of the values by what a broken channel delivers."""
    wrong = np.array([np.nan, np.inf, -np.inf, 1e301, -1e301, -0.0, 5e-324])
    places = random.random(len(values)) < share
    values[places] = random.choice(wrong, size=int(places.sum()))
    return values
