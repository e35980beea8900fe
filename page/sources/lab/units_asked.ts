/** In which units numbers are: asked, and never guessed. */

import type { ShownSignal } from "./data.ts";
import { element } from "./faceplates.ts";
import type { OtherUnit } from "./laws_data.ts";
import { numberText } from "../words.ts";

/** A signal with one percent of its range [SI]; undefined where it has none. */
export interface AskedSignal {
  signal: ShownSignal;
  percent: number | undefined;
  /** Other units that are known of it. */
  others: OtherUnit[];
}

interface Choice {
  words: string;
  /** What one of these units is of each signal [SI]. */
  scales: number[];
}

/** Return the units that all of some signals may be in. */
export function unitChoices(signals: AskedSignal[]): Choice[] {
  const shown = signals.map(({ signal }) => signal.unit || "1");
  const found = [{ words: `${named(shown)}, as shown here`, scales: signals.map(({ signal }) => 1 / signal.factor) }];
  const percents = signals.map(({ percent }) => percent);
  const isShown = shown.every((unit) => unit === "%");
  if (!isShown && percents.every((each) => each !== undefined))
    found.push({ words: "% of the range", scales: percents.map((each) => each!) });
  for (const { unit } of signals[0]?.others ?? []) {
    const sizes = signals.map(({ others }) => others.find((each) => each.unit === unit)?.size);
    if (sizes.some((each) => each === undefined)) continue;
    const told = signals.map(({ signal }, place) => `1 ${unit} = ${numberText(sizes[place]! * signal.factor, 4)} ${signal.unit || "1"}`);
    found.push({ words: `${unit}: ${named(told)}`, scales: sizes.map((each) => each!) });
  }
  return found;
}

/** A question with a choice for each unit, and one for a unit of which the reader types how much it is. */
export class UnitsAsked {
  readonly place: HTMLElement;
  private readonly select = element("select", "");
  private readonly field = element("input", "");
  private readonly other = element("span", "other");
  private choices: Choice[] = [];
  private signals: AskedSignal[] = [];

  constructor(question: string, changed: () => void) {
    this.place = element("p", "asked");
    const label = element("label", "", `${question} `);
    label.append(this.select);
    Object.assign(this.field, { type: "text", inputMode: "decimal", size: 6, autocomplete: "off" });
    this.place.append(label, this.other);
    this.select.addEventListener("change", () => {
      this.other.hidden = !this.isOther;
      changed();
    });
    this.field.addEventListener("input", () => {
      this.field.setAttribute("aria-invalid", String(this.wrong !== null));
      changed();
    });
  }

  /** Ask of these signals; what was answered of the same before stays. */
  ask(signals: AskedSignal[]): void {
    const before = this.select.selectedIndex;
    const isSame = signals.map(({ signal }) => signal.name).join() === this.signals.map(({ signal }) => signal.name).join();
    this.signals = signals;
    this.choices = unitChoices(signals);
    // Another unit is one for all of them.
    const isOne = new Set(signals.map(({ signal }) => signal.unit)).size === 1;
    const words = ["choose…", ...this.choices.map((each) => each.words), ...(isOne ? ["another unit"] : [])];
    this.select.replaceChildren(...words.map((each) => element("option", "", each)));
    this.select.selectedIndex = isSame ? Math.max(0, before) : 0;
    const unit = signals[0]?.signal.unit || "1";
    this.field.setAttribute("aria-label", `One of that unit in ${unit}`);
    this.other.replaceChildren(" of which one is ", this.field, ` ${unit}`);
    this.other.hidden = !this.isOther;
  }

  /** Forget the answer, which was that of another file. */
  forget(): void {
    this.signals = [];
    this.field.value = "";
    this.field.setAttribute("aria-invalid", "false");
  }

  /** What one unit of each signal is in SI; null until that is answered. */
  get scales(): number[] | null {
    const chosen = this.choices[this.select.selectedIndex - 1];
    if (chosen) return chosen.scales;
    const { size } = this;
    if (!this.isOther || size === null) return null;
    return this.signals.map(({ signal }) => size / signal.factor);
  }

  /** What is wrong in the size of another unit, in words; null where nothing is. */
  get wrong(): string | null {
    const typed = this.field.value.trim();
    return this.isOther && typed && this.size === null ? `“${typed.slice(0, 30)}” is not a number above 0, such as 20 or 100/15` : null;
  }

  /** The size of another unit, as a number or a fraction; null where it is none. */
  private get size(): number | null {
    const parts = this.field.value.split("/").map((each) => Number(each.trim().replace(",", ".") || NaN));
    const [above, below = 1] = parts;
    const size = parts.length > 2 ? NaN : above! / below;
    return size > 0 && size < 1e12 ? size : null;
  }

  /** What one unit of an input or output is, in words. */
  unitWords(end: string): string {
    const chosen = this.choices[this.select.selectedIndex - 1];
    if (chosen) return `${end}s in ${chosen.words.replace(/, as shown here$/, "")}`;
    return `1 ${end} unit = ${this.field.value.trim()} ${this.signals[0]?.signal.unit || "1"}`;
  }

  private get isOther(): boolean {
    return this.choices.length > 0 && this.select.selectedIndex === this.choices.length + 1;
  }
}

function named(units: string[]): string {
  return [...new Set(units)].join(" and ");
}
