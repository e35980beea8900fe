"""The function that makes noise, compiled for processors that have less than this one."""

import ctypes
from dataclasses import replace
from functools import partial

import llvmlite.binding as llvm
import numpy as np
import pytest

from clepsydra.engine import compiler
from clepsydra.engine.batch_noise import BatchNoise, InputNoise, LaidNoise
from clepsydra.engine.host import host
from clepsydra.engine.kernel_form import KernelForm
from clepsydra.engine.noise_code import CHUNK, noise_code
from clepsydra.engine.object_cache import ObjectCache
from clepsydra.engine.white_noise import seed_of, white_noise

#: LLVM's name of a processor, what it has that this one needs to have, and doubles of a vector.
PROCESSORS = [("x86-64", "sse2", 2), ("sandybridge", "avx", 4), ("haswell", "avx2", 4)]


def machine(name, optimisation):
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    target = llvm.Target.from_default_triple()
    return target.create_target_machine(
        cpu=name, opt=optimisation, reloc="pic", codemodel="small", jit=True
    )


@pytest.mark.parametrize(("name", "needed", "width"), PROCESSORS)
@pytest.mark.parametrize("lanes", [1, 2, 4, 8, 16])
def test_every_bit_on_every_processor(name, needed, width, lanes, monkeypatch, tmp_path):
    if not llvm.get_host_cpu_features().get(needed):
        pytest.skip(f"has no {needed}")
    other = replace(host(), name=name, features="", lanes=width, fuses=False, refines=False)
    compiled = partial(compiler.kept_object, machine=partial(machine, name))
    monkeypatch.setattr(compiler, "kept_object", compiled)
    monkeypatch.setattr(compiler, "host", lambda: other)
    monkeypatch.setattr("clepsydra.engine.batch_noise.host", lambda: other)
    noises = {"u": InputNoise(9, 0.7, 5, 33), "v": InputNoise(2**31 + 1, 2.0, 0, 1000)}
    numbers = np.arange(lanes) * 1001
    noise = LaidNoise(
        BatchNoise(noises, 6, numbers), ["u", "v"], lanes, lanes, ObjectCache(tmp_path)
    )
    further = noise.for_a_thread()
    (address, plan, seeds, made), (sample,) = further(0, 0)
    compiler.signature_of(3, 3)(address)(made, plan, seeds, 2, sample, CHUNK)
    entries = ctypes.cast(made, ctypes.POINTER(ctypes.c_double * (2 * CHUNK * lanes))).contents
    chunk = np.array(entries).reshape(2, CHUNK, lanes)
    for rows, each in zip(chunk, noises.values(), strict=True):
        for lane, number in enumerate(numbers):
            expected, last = np.full(CHUNK, -0.0), min(each.first + each.count, CHUNK)
            white = white_noise(seed_of(6, number), each.stream, each.first, last - each.first)
            expected[each.first : last] = each.deviation * white
            assert rows[:, lane].tobytes() == expected.tobytes()


def test_the_code_has_the_width_of_the_processor():
    narrow, wide = (
        noise_code(KernelForm(16, processor=replace(host(), lanes=lanes))) for lanes in (2, 8)
    )
    assert "<8 x double>" in wide and "<8 x double>" not in narrow
