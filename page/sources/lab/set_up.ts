/** The rig as a task begins: its numbers, where it stands, and who has it. */

import type { TaskData } from "./lesson_data.ts";
import type { Rig } from "./rig.ts";

const MANUAL = 0;

/**
 * Set the rig up for a task, and go through the first sample of it.
 *
 * @param begun Gives a new run the numbers of what the reader has brought.
 */
export function setUp(rig: Rig, task: TaskData, begun: () => void): void {
  const { start, setup, controller, controllerStart, settings, setpoints, manual, noise } = task;
  if (start !== "stands") {
    rig.reset(start);
    begun();
  }
  const { parameters } = rig.data.setups.find(({ name }) => name === setup)!;
  const others = Object.entries(parameters).filter(([name, value]) => rig.parameter(name) !== value);
  if (others.length) rig.parameters(Object.fromEntries(others));
  if (controller) {
    const place = rig.data.controllers.findIndex(({ name }) => name === controller);
    rig.choose(place, controllerStart);
    if (Object.keys(settings).length) rig.settings(place, settings);
  }
  rig.noise(noise);
  for (const [name, value] of Object.entries(setpoints)) rig.touch(`${name}.setpoint`, value);
  for (const [name, value] of Object.entries(manual)) {
    rig.touch(`${name}.manual`, value);
    rig.touch(`${name}.mode`, MANUAL);
  }
  rig.step();
}
