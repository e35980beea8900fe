# Does the C code that I get run what was simulated?
import clepsydra as cl

plant = cl.load(cl.new_process("tank"))
controller = cl.design.simc(plant)
written = cl.export(controller, plant, "c", to="c")
print(*(path.name for path in written.files), sep="\n")
proof = cl.verify(controller, plant, to="c")
print(proof)
