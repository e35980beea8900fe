"""Interlocks act in the page of a report as in the simulation."""

from pathlib import Path

import numpy as np
from hosted_report import live_of
from tools import need

import clepsydra as cl

from .test_whole_reports import assert_same_run

ALARMED = Path(__file__).parents[2] / "alarmed-tank.toml"


def test_the_page_holds_what_the_alarms_hold(report_session):
    need("wasmtime")
    plant = cl.load(ALARMED)
    result = cl.study(plant, controllers=[cl.design.simc(plant), cl.design.lambda_(plant)])
    assert any(np.any(each.run.values["pump_1.interlock"]) for each in result.ranking)
    data = live_of(result)
    messages = [
        {"kind": "run", "run": place, "controller": place, "values": live["values"]}
        for place, live in enumerate(data["controllers"])
    ]
    ready, *posted = report_session(result, data)(messages=messages)
    assert ready == {"kind": "ready"}
    for live, ran in zip(data["controllers"], posted[::2], strict=True):
        assert_same_run(result, result.ranking[live["controller"]], live, ran)
