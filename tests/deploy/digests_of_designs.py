"""Print the digests of exports: `test_digests_of_kernels.py` runs it under each kernel.

It reads the name of a process in each line, and answers with a line of JSON.
"""

import hashlib
import json
import sys

from clepsydra import ClepsydraError
from clepsydra.deploy.c99.printer import print_c
from clepsydra.deploy.exportable import exportable
from clepsydra.deploy.printing.heading import digest
from clepsydra.deploy.process_program import process_program
from clepsydra.linear.analysis import analyse
from clepsydra.process.reader import load_process
from clepsydra.studies.designs import DESIGNS

#: Where the whole export is compared: several loops, one, and pumps that are switched. Of others
#: the controllers are, with all that linear algebra made of them: shells and texts ask none of it.
EXPORTED = ("quadruple-tank", "averaging-tank", "wet-well")


def digests(process):
    """Return controller to its digest, and that of the printed C; or to why it does not apply."""
    analysis = analyse(load_process(process))
    point = analysis.operating_point
    found = {"the process": digest(process_program(point))}
    for name in DESIGNS:
        try:
            controller = DESIGNS[name](analysis)
        except ClepsydraError as refusal:
            found[name] = str(refusal)
            continue
        found[name] = [digest(controller.program())]
        if process in EXPORTED:
            ready = exportable(controller, point)
            printed = print_c(ready.program, origin=ready.origin)
            text = (printed.header + printed.source).encode()
            found[name] += [digest(ready.program), hashlib.sha256(text).hexdigest()]
    return found


if __name__ == "__main__":
    for line in sys.stdin:
        print(json.dumps(digests(line.strip())), flush=True)
