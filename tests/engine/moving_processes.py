"""A process of the catalogue as a program whose inputs are given."""

from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.motion_block import MotionBlock
from clepsydra.process.reader import load_process
from clepsydra.program.builder import BlockBuilder
from clepsydra.program.program import Program


def moving(name: str, substeps: int) -> tuple[OperatingPoint, Program]:
    """Return the operating point of a process, and the program of a sample without outputs."""
    process = load_process(name)
    motion = MotionBlock(process.motion, process.sampling_period, substeps, ())
    outside = (*process.inputs, *process.disturbances)
    size = len(motion.state)
    builder = BlockBuilder(size + len(outside) + len(process.parameters))
    given = range(size, size + len(outside) + len(process.parameters))
    block = builder.finish(motion.move(builder, range(size), given))
    program = Program(name, motion.state, outside, process.parameters, (), block)
    return find_equilibrium(process), program
