/** The faults of sensors and final elements as rows of a panel, a choice each. */

import type { ShownSignal } from "./data.ts";
import { element } from "./faceplates.ts";
import { ACTUATOR_FAULTS, actuatorFault, breakActuator, breakSensor, SENSOR_FAULTS, sensorFault } from "./faults.ts";
import type { SeenRig } from "./seen_rig.ts";

export class FaultRows {
  readonly rows: HTMLElement[];
  private readonly updates: (() => void)[] = [];

  constructor(rig: SeenRig, signals: Map<string, ShownSignal>, changed: () => void) {
    const { measurements, inputs } = rig.data;
    const of = (name: string): ShownSignal => signals.get(name)!;
    this.rows = [
      ...measurements.map((name) =>
        this.row(name, SENSOR_FAULTS, () => sensorFault(rig, of(name)), (fault) => (breakSensor(rig, of(name), fault), changed())),
      ),
      ...inputs.map((name) =>
        this.row(name, ACTUATOR_FAULTS, () => actuatorFault(rig, of(name)), (fault) => (breakActuator(rig, of(name), fault), changed())),
      ),
    ];
  }

  show(): void {
    for (const update of this.updates) update();
  }

  private row<Fault extends string>(name: string, faults: readonly Fault[], now: () => Fault, set: (fault: Fault) => void): HTMLElement {
    const row = element("label", "row");
    const select = element("select", "");
    select.setAttribute("aria-label", `Fault of ${name}`);
    select.append(...faults.map((fault) => element("option", "", fault)));
    select.addEventListener("change", () => set(faults[select.selectedIndex]!));
    this.updates.push(() => {
      const fault = now();
      if (document.activeElement !== select || select.value !== fault) select.value = fault;
      row.classList.toggle("abnormal", select.selectedIndex > 0);
    });
    row.append(element("b", "", name), select);
    return row;
  }
}
