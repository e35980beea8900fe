/** Which trends there are beside those of the loops: the reader's choice of what else was recorded. */

import type { PlantData } from "./data.ts";
import { element } from "./faceplates.ts";

export class MoreTrends {
  readonly place = element("details", "more");
  private readonly names: string[];
  private readonly chosen = new Set<string>();

  constructor(data: PlantData, changed: () => void) {
    const { measurements, controlled, disturbances } = data;
    this.names = [...measurements.filter((name) => !controlled.includes(name)), ...disturbances];
    const boxes = element("div", "tools");
    boxes.append(...this.names.map((name) => {
      const label = element("label", "");
      const box = Object.assign(element("input", ""), { type: "checkbox" });
      box.setAttribute("aria-label", `Trend of ${name}`);
      box.addEventListener("change", () => {
        if (box.checked) this.chosen.add(name);
        else this.chosen.delete(name);
        changed();
      });
      label.append(box, ` ${name}`);
      return label;
    }));
    this.place.append(element("summary", "", "More trends"), boxes);
    this.place.hidden = this.names.length === 0;
  }

  /** Those that are chosen, in the order of the list. */
  get shown(): string[] {
    return this.names.filter((name) => this.chosen.has(name));
  }
}
