# The pump is weaker than its file says: what is its gain, and which PI suits it?
import clepsydra as cl

believed = cl.load(cl.new_process("tank"))
real = believed.with_values({"pump_1.gain": "2.664 cm^3/(s V)"})  # stands in for the plant
steps = [cl.step("pump_1", "+0.5 V", at="30 s"), cl.step("pump_1", "-0.5 V", at="5 min")]
cl.simulate(real, None, steps, duration="10 min").save("record.csv")
found = cl.identify("record.csv", plant=believed, parameters=["pump_1.gain"])
print(found.verdict)
print(f"pump_1.gain {1e6 * found.values['pump_1.gain']:.3f} cm³/(s V)")
print("as believed:", cl.design.simc(believed).design)
print("as found:   ", cl.design.simc(found.plant).design)
