"""Print the digests of exports: `test_digests_of_kernels.py` runs it under each kernel.

It reads the name of a process in each line, and answers with a line of JSON.
"""

import hashlib
import json
import sys

from clepsydra import ClepsydraError
from clepsydra.deploy.export import export_c
from clepsydra.deploy.exportable import exportable
from clepsydra.deploy.printing.heading import digest
from clepsydra.deploy.process_program import process_program
from clepsydra.linear.analysis import analyse
from clepsydra.loop.step_size import substeps_for
from clepsydra.process.reader import load_process
from clepsydra.studies.designs import DESIGNS


def digests(process):
    """Return controller to digest and the printed C, or to why it does not apply."""
    analysis = analyse(load_process(process))
    point = analysis.operating_point
    found = {"the process": digest(process_program(point, substeps_for(analysis.model)))}
    for name in DESIGNS:
        try:
            exported = export_c(exportable(DESIGNS[name](analysis), point))
        except ClepsydraError as refusal:
            found[name] = str(refusal)
        else:
            texts = b"".join(exported.files.values())
            found[name] = [exported.facts["digest"], hashlib.sha256(texts).hexdigest()]
    return found


if __name__ == "__main__":
    for line in sys.stdin:
        print(json.dumps(digests(line.strip())), flush=True)
