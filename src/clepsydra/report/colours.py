"""One colour a signal, the same in drawing, trends and tables."""

from __future__ import annotations

from itertools import cycle

from clepsydra.process.process import Process

#: Text, axes and outlines.
INK = "#1f2328"
#: Secondary text and thin lines.
MUTED = "#59636e"
#: Forbidden zones beyond a limit.
LIMIT = "#d8dde3"

#: Colours that remain apart for colour-blind readers and on white paper: those of Okabe and Ito
#: without yellow, then dark ones of Tol's "muted" scheme.
PALETTE = (
    "#0072B2",
    "#D55E00",
    "#009E73",
    "#CC79A7",
    "#E69F00",
    "#56B4E9",
    "#332288",
    "#882255",
    "#999933",
    "#661100",
    "#117733",
    "#AA4499",
)


def signal_colours(process: Process) -> dict[str, str]:
    """Give every signal of a process its colour.

    A measurement and its setpoint have the colour of the state that the sensor shows. The order
    is: controlled states, other states, manipulated variables, disturbances; colours repeat
    after twelve signals, and every line is named beside it as well.

    Returns
    -------
    dict
        Signal name to "#rrggbb".

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> colours = signal_colours(load_process("quadruple-tank"))
    >>> colours["level_1"], colours["tank_1.level"], colours["pump_1"]
    ('#0072B2', '#0072B2', '#E69F00')
    """
    order = [process.measured_state[name] for name in process.controlled]
    for group in (process.state, process.inputs, process.disturbances):
        order += [signal.name for signal in group]
    colours = dict(zip(dict.fromkeys(order), cycle(PALETTE), strict=False))
    for measurement, state in process.measured_state.items():
        colours[measurement] = colours[state]
    return colours
