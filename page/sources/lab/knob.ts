/** A number that a hand sets: a slider and a typed number of one signal. */

import type { ShownSignal } from "./data.ts";
import { panelText } from "./quantities.ts";
import { TypedField } from "./typed_field.ts";

/** A slider has so many steps, and the wheel turns it by so many of them, with Alt by one. */
const [STEPS, TURN] = [1000, 10];

export class Knob {
  readonly place = document.createElement("div");
  private readonly slider = document.createElement("input");
  private readonly typed: TypedField;
  private readonly signal: ShownSignal;

  constructor(label: string, signal: ShownSignal, range: [number, number], set: (value: number) => void) {
    this.signal = signal;
    this.place.className = "knob";
    this.place.title = "Arrow keys and Page Up and Down move the slider; so does the wheel with Shift, or finely with Alt.";
    const { slider } = this;
    this.typed = new TypedField(`${label}${signal.unit ? ` in ${signal.unit}` : ""}, typed`, signal, set);
    const [low, high] = range.map((end) => end * signal.factor) as [number, number];
    Object.assign(slider, { type: "range", min: String(low), max: String(high), step: String((high - low) / STEPS) });
    slider.setAttribute("aria-label", label);
    const slid = (): void => {
      this.typed.clear();
      set(Number(slider.value) / signal.factor);
    };
    slider.addEventListener("input", slid);
    // Alone it scrolls the page.
    this.place.addEventListener("wheel", (event) => {
      if (slider.disabled || !(event.shiftKey || event.altKey)) return;
      event.preventDefault();
      const turned = -Math.sign(event.deltaY || event.deltaX) * (event.altKey ? 1 : TURN);
      slider.value = String(Number(slider.value) + (turned * (high - low)) / STEPS);
      slid();
    }, { passive: false });
    const unit = document.createElement("span");
    unit.className = "unit";
    unit.textContent = signal.unit;
    this.place.append(slider, this.typed.field, unit, this.typed.reason);
  }

  show(value: number, isInHand = true): void {
    const { slider, typed } = this;
    slider.disabled = typed.field.disabled = !isInHand;
    if (!isInHand) typed.clear();
    const text = panelText(this.signal, value);
    typed.show(text);
    slider.value = String(value * this.signal.factor);
    slider.setAttribute("aria-valuetext", `${text} ${this.signal.unit}`.trim());
  }
}
