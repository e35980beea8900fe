"""The live part of a report, run by Wasmtime as a page runs it."""

import base64
import math
import zlib

import numpy as np
from hosted_pages import hosted_module, told_noise

from clepsydra.report.html import _shown_first
from clepsydra.report.live.live_data import live_data
from clepsydra.report.overlay import event_windows, shown_signals
from clepsydra.studies.recommendation import recommend


def unpacked(text):
    return zlib.decompress(base64.b64decode(text))


def numbers(text):
    return np.frombuffer(unpacked(text), "<f8")


def live_of(result):
    """Return what the report of a study carries."""
    return live_data(result, *windows_of(result), _first(result))


def windows_of(result):
    """Return the rows of charts of a report, and its events."""
    signals = shown_signals(result)
    return signals, event_windows(result, signals, _first(result))


def _first(result):
    return _shown_first(result, recommend(result.ranking, result.accept))


def hosted(data, number):
    return hosted_module(unpacked(data["modules"][number]))


def inputs_of(data):
    """Return the inputs of a run [samples, inputs]."""
    columns = []
    for each in data["inputs"]:
        column = np.full(data["samples"], each["constant"])
        if each["packed"] is not None:
            column = numbers(each["packed"]).copy()
        if noise := each["noise"]:
            first, made = told_noise(noise)
            column[first : first + len(made)] += made
        columns.append(column)
    return np.column_stack(columns)


def law_at_rest(data, live, values):
    """Return the state of the law at rest with these values of its parameters."""
    law = live["law"]
    module = hosted(data, law["module"])
    own = np.array(law["state"], float)
    groups = [own, np.zeros(len(values)), np.array(law["manual"]), np.zeros(1)]
    places = module.put(groups)
    state, parameters, inputs, none = places
    addresses = [state, parameters, inputs, none, none, none]

    def taken_over(values):
        module.write(parameters, np.array(values))
        module.write(state, own)
        module.write(inputs, np.array(law["manual"]))
        for sample in range(law["most"]):
            before = module.read(state, len(own))
            module.call(addresses)
            after = module.read(state, len(own))
            still = np.abs(after - before) <= law["rounding"] * np.maximum(1.0, np.abs(after))
            if sample >= law["samples"] and np.all(still):
                break
        module.write(inputs, np.array(law["automatic"]))
        module.call(addresses)
        return module.read(state, len(own))

    here = taken_over(live["values"])
    moved = taken_over(values) - here
    noticed = np.abs(moved) > law["rounding"] * np.maximum(1.0, np.abs(here))
    noticed[law["rings"]] = False
    return np.where(noticed, own + moved, own)


def run(data, live, values):
    """Return the record [samples, outputs] and the last state of a loop with these values."""
    loop = live["loop"]
    state, parameters = np.array(loop["state"], float), np.array(loop["parameters"], float)
    parameters[loop["first"] : loop["first"] + len(values)] = values
    law = law_at_rest(data, live, values)
    state[loop["law"] : loop["law"] + len(law)] = law
    rings = [np.full(each["length"], each["initial"]) for each in loop["rings"]]
    record = np.zeros(data["samples"] * loop["outputs"])
    module = hosted(data, loop["module"])
    groups = [state, parameters, inputs_of(data).ravel(), np.zeros(1), record]
    places = module.put([*groups, np.concatenate([*rings, np.zeros(1)])])
    module.call(places, samples=data["samples"])
    found = module.read(places[4], len(record)).reshape(data["samples"], -1)
    return found, module.read(places[0], len(state))


def sums(live, state):
    """Return the scores that the loop adds up, by key."""
    finish = {
        "": lambda value: value,
        "ratio": lambda out, into: out / into if into > 0.0 else math.nan,
        "deviation": lambda squares, count: math.sqrt(squares / count / 2.0) if count else math.nan,
    }
    return {
        each["key"]: finish[each["finish"]](*state[each["states"]])
        for each in live["scores"]
        if each["kind"] == "fold"
    }
