/** A number that a hand sets: a slider and a typed number of one signal. */

import type { ShownSignal } from "./data.ts";
import { panelText, typed } from "./quantities.ts";

const STEPS = 1000;

export class Knob {
  readonly place = document.createElement("div");
  private readonly slider = document.createElement("input");
  private readonly field = document.createElement("input");
  private readonly signal: ShownSignal;

  constructor(label: string, signal: ShownSignal, range: [number, number], set: (value: number) => void, refuse: (words: string) => void) {
    this.signal = signal;
    this.place.className = "knob";
    const { slider, field } = this;
    const [low, high] = range.map((end) => end * signal.factor) as [number, number];
    Object.assign(slider, { type: "range", min: String(low), max: String(high), step: String((high - low) / STEPS) });
    slider.setAttribute("aria-label", label);
    Object.assign(field, { type: "text", inputMode: "decimal", size: 7, autocomplete: "off" });
    field.setAttribute("aria-label", `${label}${signal.unit ? ` in ${signal.unit}` : ""}, typed`);
    slider.addEventListener("input", () => set(Number(slider.value) / signal.factor));
    field.addEventListener("change", () => {
      const found = typed(signal, field.value);
      if (typeof found === "number") set(found);
      else refuse(found);
      field.blur();
    });
    field.addEventListener("keydown", ({ key }) => {
      if (key === "Enter") field.blur();
    });
    const unit = document.createElement("span");
    unit.className = "unit";
    unit.textContent = signal.unit;
    this.place.append(slider, field, unit);
  }

  show(value: number, isInHand = true): void {
    this.slider.disabled = !isInHand;
    const text = panelText(this.signal, value);
    if (document.activeElement !== this.field && this.field.value !== text) this.field.value = text;
    this.slider.value = String(value * this.signal.factor);
    this.slider.setAttribute("aria-valuetext", `${text} ${this.signal.unit}`.trim());
  }
}
