/** The process drawing alive: levels, numbers and what stands still. */

import type { ShownSignal } from "./data.ts";
import { share, shownText } from "./quantities.ts";

type Value = (name: string) => number;

export class Drawing {
  private readonly updates: ((value: Value) => void)[] = [];
  readonly place: HTMLElement;

  constructor(place: HTMLElement, signals: Map<string, ShownSignal>) {
    this.place = place;
    this.each("level", signals, (element, signal) => {
      const height = Number(element.dataset.height);
      return (value) => {
        const filled = Math.min(1, Math.max(0, share(signal, value(signal.name)) ?? 0));
        element.setAttribute("transform", `translate(0 ${(-height * filled).toFixed(2)})`);
      };
    });
    this.each("value", signals, (element, signal) => written(element, (value) => shownText(signal, value(signal.name))));
    this.each("percent", signals, (element, signal) =>
      written(element, (value) => {
        const filled = share(signal, value(signal.name));
        element.classList.toggle("abnormal", filled !== undefined && (filled <= 0 || filled >= 1));
        return filled === undefined ? "" : `${(100 * filled).toFixed(0)} %`;
      }),
    );
    for (const element of this.all("setpoint")) {
      const name = element.dataset.setpoint!;
      const signal = signals.get(name.replace(/\.setpoint$/, ""));
      if (signal) this.updates.push(written(element, (value) => `SP ${shownText(signal, value(name))}`));
    }
    this.each("of", signals, (element, signal) => (value) => {
      // Of a forced flow that may break off it is told whether it runs.
      const running = value(`${signal.name}.running`);
      const moving = Number.isNaN(running) ? value(signal.name) - Math.max(0, signal.low ?? 0) : running;
      element.classList.toggle("stopped", !(moving > 0));
    });
  }

  show(value: Value): void {
    for (const update of this.updates) update(value);
  }

  private all(kind: string): SVGElement[] {
    return [...this.place.querySelectorAll<SVGElement>(`[data-${kind}]`)];
  }

  private each(
    kind: string, signals: Map<string, ShownSignal>,
    made: (element: SVGElement, signal: ShownSignal) => (value: Value) => void,
  ): void {
    for (const element of this.all(kind)) {
      const signal = signals.get(element.dataset[kind]!);
      if (signal) this.updates.push(made(element, signal));
    }
  }
}

/** Return what writes words into an element where they have changed. */
function written(element: Element, words: (value: Value) => string): (value: Value) => void {
  return (value) => {
    const text = words(value);
    if (element.textContent !== text) element.textContent = text;
  };
}
