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
  /** Go on from where it stands as another run. */
  goOn(): void;
  save(): void;
  /** Bring a controller of one's own. */
  bring(): void;
}

/** What keys press too. */
export type Pressed = "step" | "noise" | "rest" | "empty" | "here" | "save";

export class Bar {
  private readonly go = element("button", "go", "Run");
  private readonly told = element("span", "told", "");
  private readonly controller: HTMLSelectElement;
  private readonly noise = element("input", "");
  private isRunning = false;
  private readonly pressed: Record<Pressed, HTMLElement>;
  private readonly speed: HTMLSelectElement;

  constructor(place: HTMLElement, titles: string[], handler: Handler) {
    this.go.addEventListener("click", () => handler.run(!this.isRunning));
    const speed = choice("Speed", SPEEDS.map((times) => (times === Infinity ? "as fast as it goes" : `${times}×`)));
    speed.select.addEventListener("change", () => handler.speed(SPEEDS[speed.select.selectedIndex]!));
    const controller = choice("Controller", titles);
    this.controller = controller.select;
    titles.forEach((_, number) => (this.controller.options[number]!.value = String(number)));
    this.controller.addEventListener("change", () => handler.choose(Number(this.controller.value)));
    const noise = element("label", "", "Noise ");
    const box = Object.assign(this.noise, { type: "checkbox" });
    box.addEventListener("change", () => handler.noise(box.checked));
    noise.append(box);
    this.speed = speed.select;
    this.pressed = {
      step: button("One sample", () => handler.step()),
      noise: box,
      rest: button("Start at rest", () => handler.begin("rest")),
      empty: button("Start empty", () => handler.begin("empty")),
      here: button("Start here", () => handler.goOn()),
      save: button("Save session", () => handler.save()),
    };
    const { step, rest, empty, here, save } = this.pressed;
    const own = button("Load or type one…", () => handler.bring());
    place.append(this.go, step, speed.label, controller.label, own, noise, rest, empty, here, save, this.told);
  }

  /** Press what a key stands for. */
  press(what: Pressed): void {
    this.pressed[what].click();
  }

  /** Take the next speed, or the one before. */
  faster(steps: number): void {
    const { speed } = this;
    speed.selectedIndex = Math.min(speed.options.length - 1, Math.max(0, speed.selectedIndex + steps));
    speed.dispatchEvent(new Event("change"));
  }

  /** Offer a controller by a name. */
  offer(controller: number, title: string): void {
    const known = this.optionOf(controller);
    const option = known ?? element("option", "");
    Object.assign(option, { value: String(controller), textContent: title });
    if (!known) this.controller.append(option);
  }

  /** Show who has the rig, by a name that is told where it is not offered yet. */
  chosen(controller: number, title: string): void {
    if (!this.optionOf(controller)) this.offer(controller, title);
    this.controller.value = String(controller);
  }

  /** Show whether sensors are noisy, at another moment. */
  stand(isNoisy: boolean): void {
    this.noise.checked = isNoisy;
  }

  private optionOf(controller: number): HTMLOptionElement | undefined {
    return [...this.controller.options].find(({ value }) => value === String(controller));
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
