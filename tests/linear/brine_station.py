"""A station that blends brine with water: a level without an outlet, and a strength."""

#: Brine of 200 g/l and water to 40 g/l: of a demand q the brine is a fifth. The pump gives 40 l/min
#: at most, the valve 0.6 m³/h = 10 l/min.
STATION = """
name = "station"
sampling_period = "5 s"
controlled = ["level", "strength"]
[components.salt]
range = ["0 g/l", "100 g/l"]
[reservoirs.water]
[reservoirs.brine]
concentration = { salt = "200 g/l" }
[tanks.blender]
diameter = "1.2 m"
height = "1.5 m"
[pumps.water_pump]
source = "water"
destination = "blender"
gain = "0.4 l/(min %)"
range = ["0 %", "100 %"]
[valves.brine_valve]
source = "brine"
destination = "blender"
kv = "0.6 m^3/h"
pressure = "1 bar"
range = ["0 %", "100 %"]
[flows.demand]
source = "blender"
range = ["0 l/min", "90 l/min"]
nominal = "20 l/min"
[sensors.level]
tank = "blender"
range = ["0 m", "1.5 m"]
[sensors.strength]
tank = "blender"
component = "salt"
range = ["0 g/l", "100 g/l"]
[operating_point]
level = "1 m"
strength = "40 g/l"
"""
