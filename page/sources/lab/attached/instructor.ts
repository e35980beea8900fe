/** The panel of an instructor: faults of sensors, of final elements, and of the wires. */

import type { ShownSignal } from "../data.ts";
import { element } from "../faceplates.ts";
import { FaultRows } from "../fault_rows.ts";
import { group } from "../hands.ts";
import type { SeenRig } from "../seen_rig.ts";
import { WIRES } from "../touch_words.ts";
import { numberText } from "../../words.ts";

const DELAYS = [0, 0.05, 0.2, 1, 5];
const LOSSES = [0, 0.01, 0.1, 0.5, 1];

const delayText = (seconds: number): string => (seconds ? `${numberText(1000 * seconds, 4)} ms later` : "at once");
const lossText = (share: number): string => (share ? `${numberText(100 * share, 3)} %` : "none");
const cutText = (is: number): string => (is ? "pulled" : "plugged in");

export class InstructorPanel {
  private readonly rig: SeenRig;
  private readonly changed: () => void;
  private readonly updates: (() => void)[] = [];

  constructor(place: HTMLElement, rig: SeenRig, signals: Map<string, ShownSignal>, changed: () => void) {
    this.rig = rig;
    this.changed = changed;
    const faults = new FaultRows(rig, signals, changed);
    this.updates.push(() => faults.show());
    const wires = [
      this.wire("Answers come", WIRES.delay, DELAYS, delayText),
      this.wire("Lost requests", WIRES.loss, LOSSES, lossText),
      this.wire("Cable", WIRES.cut, [0, 1], cutText),
    ];
    const panel = element("div", "groups");
    panel.append(group("Faults", faults.rows), group("Wires", wires));
    place.append(element("h2", "", "Actions"), panel);
  }

  show(): void {
    for (const update of this.updates) update();
  }

  /** Return a row with a choice of numbers; what a script has set is shown too. */
  private wire(label: string, input: string, presets: number[], told: (value: number) => string): HTMLElement {
    const row = element("label", "row");
    const select = element("select", "");
    const other = element("option", "", "");
    other.hidden = true;
    select.append(...presets.map((value) => element("option", "", told(value))), other);
    select.setAttribute("aria-label", `Wires: ${label.toLowerCase()}`);
    select.addEventListener("change", () => {
      this.rig.touch(input, presets[select.selectedIndex]!);
      this.changed();
    });
    this.updates.push(() => {
      const value = this.rig.value(input);
      const place = presets.indexOf(value);
      if (place < 0) other.textContent = told(value);
      const wanted = place < 0 ? presets.length : place;
      if (select.selectedIndex !== wanted) select.selectedIndex = wanted;
      row.classList.toggle("abnormal", value !== 0);
    });
    row.append(element("b", "", label), select);
    return row;
  }
}
