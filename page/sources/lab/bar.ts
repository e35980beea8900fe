/** The bar above the rig: time, who has the rig, where it begins, and its session as a file. */

import { numberText, timeText } from "../words";
import type { Start } from "./data.ts";
import { element } from "./faceplates.ts";

const SPEEDS = [1, 10, 100, 1000, Infinity];

export interface Handler {
  run(isRunning: boolean): void;
  step(): void;
  speed(times: number): void;
  choose(controller: number): void;
  noise(isOn: boolean): void;
  begin(start: Start): void;
  save(): void;
}

export class Bar {
  private readonly go = element("button", "go", "Run");
  private readonly told = element("span", "told", "");
  private isRunning = false;

  constructor(place: HTMLElement, titles: string[], handler: Handler) {
    this.go.addEventListener("click", () => handler.run(!this.isRunning));
    const speed = choice("Speed", SPEEDS.map((times) => (times === Infinity ? "as fast as it goes" : `${times}×`)));
    speed.select.addEventListener("change", () => handler.speed(SPEEDS[speed.select.selectedIndex]!));
    const controller = choice("Controller", titles);
    controller.select.addEventListener("change", () => handler.choose(controller.select.selectedIndex));
    const noise = element("label", "", "Noise ");
    const box = Object.assign(element("input", ""), { type: "checkbox" });
    box.addEventListener("change", () => handler.noise(box.checked));
    noise.append(box);
    place.append(
      this.go, button("One sample", () => handler.step()), speed.label, controller.label, noise,
      button("Start at rest", () => handler.begin("rest")), button("Start empty", () => handler.begin("empty")),
      button("Save session", () => handler.save()), this.told,
    );
  }

  /** Tell the time of the plant [s], and how fast it runs. */
  show(isRunning: boolean, time: number, speed: number): void {
    this.isRunning = isRunning;
    const word = isRunning ? "Pause" : "Run";
    if (this.go.textContent !== word) this.go.textContent = word;
    const fast = isRunning ? `, ${numberText(speed, 2)} times real time` : ", paused";
    const text = timeText(time) + fast;
    if (this.told.textContent !== text) this.told.textContent = text;
  }
}

function button(words: string, action: () => void): HTMLButtonElement {
  const found = element("button", "", words);
  found.addEventListener("click", action);
  return found;
}

function choice(words: string, options: string[]): { label: HTMLLabelElement; select: HTMLSelectElement } {
  const label = element("label", "", `${words} `);
  const select = element("select", "");
  select.append(...options.map((each) => element("option", "", each)));
  label.append(select);
  return { label, select };
}
