"""From a liquid-tank process on paper to a proven controller in the PLC.

>>> import clepsydra as cl
>>> process = cl.load_process("quadruple-tank")
>>> cl.analyse(process).minimum_phase
True
"""

from clepsydra.base.lazy import lazy_names

__version__ = "0.1.0"

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "ClepsydraError": "clepsydra.base.errors",
        "Connection": "clepsydra.process.element",
        "Controller": "clepsydra.controllers.controller",
        "Element": "clepsydra.process.element",
        "Flow": "clepsydra.process.flow",
        "Kernel": "clepsydra.engine.kernel",
        "LinearModel": "clepsydra.linear.linear_model",
        "Loop": "clepsydra.loop.loop",
        "OperatingPoint": "clepsydra.linear.operating_point",
        "Outlet": "clepsydra.process.outlet",
        "Process": "clepsydra.process.process",
        "Run": "clepsydra.loop.run",
        "Scenario": "clepsydra.loop.scenario",
        "Signal": "clepsydra.base.signal",
        "StepLaw": "clepsydra.program.step_law",
        "analyse": "clepsydra.linear.analysis",
        "catalogue_names": "clepsydra.process.catalogue_names",
        "closed_loop": "clepsydra.loop.closed_loop",
        "default_scenario": "clepsydra.loop.default_scenario",
        "design_lqi": "clepsydra.design.bryson",
        "design_phase_margin": "clepsydra.design.phase_margin",
        "design_simc": "clepsydra.design.simc",
        "find_equilibrium": "clepsydra.linear.equilibrium",
        "linearise": "clepsydra.linear.linearise",
        "load_process": "clepsydra.process.reader",
        "plot": "clepsydra.report.plot",
        "print_c": "clepsydra.deploy.c99",
        "print_structured_text": "clepsydra.deploy.structured_text",
        "program_of": "clepsydra.program.reader",
        "run_study": "clepsydra.study.study",
        "simulate": "clepsydra.loop.simulation",
        "write_report": "clepsydra.report.html",
    },
)
