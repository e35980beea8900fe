"""What a page does with the live part of a report, in Node.

A test takes `node`, which runs a script as `page_in_node.answered` does, or `report_session`,
which runs the worker's share with the data of a report.
"""

from functools import partial

import pytest
from page_in_node import answered, source

from clepsydra.report.html import _shown_first
from clepsydra.report.overlay import event_windows, shown_signals
from clepsydra.studies.recommendation import recommend

#: A session whose clock goes on by `given.step` whenever it is looked at; while it breathes, the
#: messages of `given.later` come in, one at a time.
SCRIPT = f"""
import {{ Session }} from "{source("live/session.ts")}";
const posted = [];
const later = [...given.later ?? []];
let now = 0;
const session = new Session({{
  post: (message) => posted.push(message),
  now: () => (now += given.step ?? 0),
  breathe: async () => {{ if (later.length) void session.take(later.shift()); }},
}});
/* first */
const {{ data, samples, frequencies = [] }} = given;
await session.take({{ kind: "load", data, samples, frequencies }});
for (const message of given.messages ?? []) await session.take(message);
answer(posted);
"""


def shown_windows(result):
    """Return the events of a report."""
    first = _shown_first(result, recommend(result.ranking, result.accept))
    return event_windows(result, shown_signals(result), first)


@pytest.fixture
def node(tmp_path):
    """Return what runs a script with what it is given, and returns what it answers."""
    return partial(answered, folder=tmp_path)


@pytest.fixture
def report_session(node):
    """Return what runs a session with the data of a report, and returns what it posts."""

    def of(result, data):
        starts = zip(shown_windows(result), data["starts"], strict=True)
        samples = [(window.samples - start).tolist() for window, start in starts]

        def posted(before="", **given):
            script = SCRIPT.replace("/* first */", before)
            return node(script, {"data": data, "samples": samples, **given})

        return posted

    return of
