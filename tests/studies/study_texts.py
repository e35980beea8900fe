"""Texts of study files, whole and right, to be damaged."""

QUADRUPLE = 'process = "quadruple-tank"\n'
BASIN = 'process = "equalisation-tank"\n'
LOOP = """[controllers.a.loops.level]
measurement = "level"
output = "outflow"
actions = "PI"
action = "direct"
gain = "2 %/%"
integral_time = "1 h"
"""


def loop(**changes):
    """Return the basin with its loop, some lines of which are changed; None leaves one out."""
    lines = []
    for line in LOOP.splitlines():
        key = line.partition(" = ")[0]
        value = changes.pop(key, line.partition(" = ")[2])
        if value is not None:
            lines.append(f"{key} = {value}" if " = " in line else line)
    lines += [f"{key} = {value}" for key, value in changes.items()]
    return BASIN + "\n".join(lines) + "\n"
