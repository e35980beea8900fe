/** The panel of hands: what they do to tanks, faults, and the numbers of the plant. */

import type { HandsOnTank, Setup, ShownSignal } from "./data.ts";
import { element } from "./faceplates.ts";
import { FaultRows } from "./fault_rows.ts";
import { PlantNumbers } from "./plant_numbers.ts";
import type { Pours } from "./pours.ts";
import type { Rig } from "./rig.ts";

export class Hands {
  private readonly rig: Rig;
  private readonly pours: Pours;
  private readonly changed: () => void;
  /** Parameters of plugged outlets, and what they were. */
  private readonly unplugged = new Map<string, number>();
  private readonly updates: (() => void)[] = [];

  constructor(place: HTMLElement, rig: Rig, signals: Map<string, ShownSignal>, pours: Pours, changed: () => void) {
    this.rig = rig;
    this.pours = pours;
    this.changed = changed;
    const { data } = rig;
    const groups: HTMLElement[] = [];
    if (data.tanks.length) groups.push(group("Tanks", data.tanks.map((tank) => this.tank(tank))));
    const faults = new FaultRows(rig, signals, changed);
    this.updates.push(() => faults.show());
    groups.push(group("Faults", faults.rows));
    if (data.setups.length > 1) groups.push(group("Set-up", [this.setups()], "wide"));
    const numbers = new PlantNumbers(rig, changed);
    this.updates.push(() => numbers.show());
    const panel = element("div", "groups");
    panel.append(...groups, numbers.place);
    place.append(element("h2", "", "Actions"), panel);
    place.hidden = false;
    this.show();
  }

  show(): void {
    for (const update of this.updates) update();
  }

  /** The set-up that the rig is in, if it is in one. */
  get setup(): Setup | undefined {
    return this.rig.data.setups.find((each) => this.has(each));
  }

  /** Tell whether the rig is in a set-up; a plug stays in, whatever the hole below it is. */
  private has({ parameters }: Setup): boolean {
    return Object.entries(parameters).every(
      ([name, value]) => (this.isPlugged(name) ? this.whole(name) : this.rig.parameter(name)) === value,
    );
  }

  private isPlugged(name: string): boolean {
    return this.rig.data.tanks.some(({ outlets }) => Object.values(outlets).includes(name)) && this.rig.parameter(name) === 0;
  }

  private tank(tank: HandsOnTank): HTMLElement {
    const { rig } = this;
    const outlets = Object.entries(tank.outlets).map(([outlet, parameter]) =>
      this.toggle("Plug", `Plug ${outlet}`, () => rig.parameter(parameter) === 0, (isOn) => {
        if (isOn) this.unplugged.set(parameter, rig.parameter(parameter));
        rig.parameters({ [parameter]: isOn ? 0 : this.whole(parameter) });
      }),
    );
    const extra = this.toggle("Extra outlet", `Extra outlet of ${tank.tank}`, () => rig.parameter(tank.extra_outlet) > 0, (isOn) =>
      rig.parameters({ [tank.extra_outlet]: isOn ? tank.area : 0 }),
    );
    const row = element("div", "row");
    row.append(element("b", "", tank.tank), this.pour(tank), extra, ...outlets);
    return row;
  }

  /** Return what an outlet is once its plug is out: what it was, or what the file says. */
  private whole(parameter: string): number {
    return this.unplugged.get(parameter) || this.rig.data.parameters.find(({ name }) => name === parameter)!.value;
  }

  private pour(tank: HandsOnTank): HTMLButtonElement {
    const { pours } = this;
    const button = element("button", "", "Pour +25 %");
    button.setAttribute("aria-label", `Pour +25 % into ${tank.tank}`);
    button.title = "A click pours a quarter of the tank; held, it pours on. Another click ends it.";
    // A click that no pointer and no key began, as that of a screen reader, is a short one.
    let isDown = false;
    const press = (): void => {
      isDown = true;
      pours.press(tank);
      this.changed();
    };
    const release = (): void => {
      pours.release(tank);
      this.changed();
    };
    const isKey = ({ key }: KeyboardEvent): boolean => key === " " || key === "Enter";
    button.addEventListener("pointerdown", ({ button: which }) => which === 0 && press());
    for (const kind of ["pointerup", "pointercancel", "pointerleave", "blur"]) button.addEventListener(kind, release);
    button.addEventListener("keydown", (event) => isKey(event) && !event.repeat && press());
    button.addEventListener("keyup", (event) => isKey(event) && release());
    button.addEventListener("click", () => {
      if (!isDown) {
        press();
        release();
      }
      isDown = false;
    });
    this.updates.push(() => showPressed(button, pours.isPouring(tank)));
    return button;
  }

  private setups(): HTMLElement {
    const { rig } = this;
    const row = element("div", "row");
    const titles = shortened(rig.data.setups.map(({ title }) => title));
    rig.data.setups.forEach((setup, place) => {
      const button = this.toggle(titles[place]!, titles[place]!, () => this.has(setup), () => {
        const open = Object.entries(setup.parameters).filter(([name, value]) => !this.isPlugged(name) || void this.unplugged.set(name, value));
        rig.parameters(Object.fromEntries(open));
      });
      button.title = setup.words;
      row.append(button);
    });
    return row;
  }

  /** Return a button that does something and is pressed while it is so. */
  private toggle(words: string, label: string, is: () => boolean, set: (isOn: boolean) => void): HTMLButtonElement {
    const button = element("button", "", words);
    if (label !== words) button.setAttribute("aria-label", label);
    button.addEventListener("click", () => {
      set(!is());
      this.changed();
    });
    this.updates.push(() => showPressed(button, is()));
    return button;
  }
}

export function showPressed(button: HTMLElement, isPressed: boolean): void {
  const pressed = String(isPressed);
  if (button.getAttribute("aria-pressed") !== pressed) button.setAttribute("aria-pressed", pressed);
}

export function group(title: string, rows: HTMLElement[], kind = ""): HTMLElement {
  const found = element("section", `group ${kind}`.trim());
  found.setAttribute("aria-label", title);
  found.append(element("h3", "", title), ...rows);
  return found;
}

/** Return titles without the words that those of the same rig have in common with the first one. */
function shortened(titles: string[]): string[] {
  const [first] = titles as [string];
  const common = first.slice(0, first.lastIndexOf(", ") + 2);
  if (common.length < 3 || titles.filter((title) => title.startsWith(common)).length < 2) return titles;
  return titles.map((title) => {
    const own = title.startsWith(common) ? title.slice(common.length) : title;
    return own[0]!.toUpperCase() + own.slice(1);
  });
}
