/** The numbers of the plant: typed in the units of its file while it runs, and back to the file's. */

import type { ParameterData } from "./data.ts";
import { element } from "./faceplates.ts";
import type { Rig } from "./rig.ts";
import { TypedField } from "./typed_field.ts";
import { numberText } from "../words";

/** Digits that are shown. */
const DIGITS = 6;

export class PlantNumbers {
  readonly place = element("details", "group numbers");
  private readonly rig: Rig;
  private readonly updates: (() => void)[] = [];
  private readonly typed: TypedField[] = [];

  constructor(rig: Rig, changed: () => void) {
    this.rig = rig;
    const { parameters, tanks, lesson } = rig.data;
    const owner = (name: string): string => name.slice(0, name.lastIndexOf("."));
    const ofHands = new Set(tanks.map((tank) => owner(tank.extra_outlet)));
    const hidden = new Set(lesson?.hides);
    const own = parameters.filter(({ name }) => !ofHands.has(owner(name)) && !hidden.has(name));
    const summary = element("summary", "", "Numbers of the plant");
    const grid = element("div", "numbers-grid");
    grid.append(...own.map((parameter) => this.row(parameter, changed)));
    const back = element("button", "", "All as in the file");
    back.addEventListener("click", () => {
      for (const each of this.typed) each.clear();
      rig.parameters(Object.fromEntries(own.filter((each) => this.isChanged(each)).map(({ name, value }) => [name, value])));
      changed();
    });
    this.updates.push(() => {
      const count = own.filter((each) => this.isChanged(each)).length;
      back.disabled = !count;
      const words = count ? `Numbers of the plant: ${count} changed` : "Numbers of the plant";
      if (summary.textContent !== words) summary.textContent = words;
    });
    this.place.append(summary, grid, back);
  }

  show(): void {
    for (const update of this.updates) update();
  }

  private isChanged({ name, value }: ParameterData): boolean {
    return this.rig.parameter(name) !== value;
  }

  private row(parameter: ParameterData, changed: () => void): HTMLElement {
    const { name, words, unit, factor, value } = parameter;
    const row = element("label", "number-row");
    const typed = new TypedField(`${words || name}${unit ? ` in ${unit}` : ""}`, parameter, (value) => {
      this.rig.parameters({ [name]: value });
      changed();
    });
    this.typed.push(typed);
    row.title = `${words || name}; in the file ${numberText(value * factor, DIGITS)} ${unit}`.trim();
    this.updates.push(() => {
      typed.show(numberText(this.rig.parameter(name) * factor, DIGITS));
      row.classList.toggle("changed", this.isChanged(parameter));
    });
    const head = element("span", "");
    // A long name breaks after its element.
    name.split(/(?<=\.)/).forEach((part, place) => head.append(...(place ? [element("wbr", "")] : []), part));
    row.append(head, typed.field, element("span", "unit", unit), typed.reason);
    return row;
  }
}
