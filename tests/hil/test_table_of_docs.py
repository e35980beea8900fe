"""The table of docs/plc.md, which the simulation made, met by the soft PLC on the tags of a rig."""

import re
from pathlib import Path

import pytest
from plc_bench import PlcBench

PAGE = Path(__file__).parents[2] / "docs" / "plc.md"
#: What the page writes to the tag of a rig.
NAMES = {
    "LIC101_sp": "level_1.sp", "P101_mode": "pump_1.mode", "P101_manual": "pump_1.manual",
    "acknowledge": "operator.acknowledge",
}  # fmt: skip


@pytest.mark.parametrize("image", ["compiled_c", "by_matiec"])
def test_every_row_is_met_in_every_digit(image, request, tmp_path):
    bench = PlcBench(request.getfixturevalue(image), tmp_path)
    table = PAGE.read_text(encoding="utf-8").split("<!-- numbers: begin -->\n")[1]
    rows = table.split("<!-- numbers: end -->")[0].splitlines()
    assert len(rows) == 11
    scans = 0
    for line in rows:
        what, after, *expected = (cell.strip() for cell in line.split("|")[1:-1])
        scans = 0 if what else scans
        for name, value in re.findall(r"(\w+) := ([\w.]+)", what):
            number = {"TRUE": 1.0, "FALSE": 0.0}.get(value) if value.isalpha() else float(value)
            if name == "LIC101_good":  # that is what its card says
                bench.instruct("level_1.sensor", number)
            else:
                bench.write(NAMES[name], number)
        outputs = bench.scan(int(after) - scans)
        scans = int(after)
        levels = [bench.read(f"level_{k}.pv").value for k in (1, 2)]
        found = [f"{x:.4f}" for x in (*levels, outputs["pump_1.out"], outputs["pump_2.out"])]
        assert [*found, f"{outputs['pump_1.status']:.0f}"] == expected, (what, after)
        assert bench.read("pump_1.status").value == outputs["pump_1.status"]
        assert bench.read("controller.heartbeat").value == outputs["watchdog"]
