# How does a tank of my own get a PI controller in Structured Text?
from pathlib import Path

import clepsydra as cl

file = cl.new_process("rain-barrel")  # rain-barrel.toml, with a comment on every key
file.write_text(file.read_text().replace('area = "28 cm^2"', 'area = "40 cm^2"'))
plant = cl.load(file)
print(plant)
controller = cl.design.simc(plant)
written = cl.export(controller, plant, "plc", to="st", fail_safe={"pump_1": "0 V"})
code = Path(written.files[0]).read_text().splitlines()
print(f"{written.files[0].name}, {len(code)} lines:", *code[:12], sep="\n")
