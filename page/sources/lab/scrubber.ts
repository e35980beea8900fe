/** The time of the run as a slider: back to any moment that there was. */

import { timeText } from "../words";
import { element } from "./faceplates.ts";
import type { SeenRig } from "./seen_rig.ts";

export class Scrubber {
  private readonly rig: SeenRig;
  private readonly slider = element("input", "");
  private readonly told = element("span", "", "");
  /** What is so while it stands in the past. */
  private readonly then: string;
  /** The sample that a hand asks for until the next picture; the slider itself may be shown anew before. */
  private asked: number | undefined;

  /** `moved` is called when the rig stands at another moment. */
  constructor(place: HTMLElement, rig: SeenRig, moved: () => void, then = "what is done now branches off") {
    this.rig = rig;
    this.then = then;
    const { slider } = this;
    const label = element("label", "", "Go back ");
    Object.assign(slider, { type: "range", step: "1" });
    slider.addEventListener("input", () => {
      const isWaiting = this.asked !== undefined;
      this.asked = Number(slider.value);
      if (isWaiting) return;
      requestAnimationFrame(() => {
        rig.goTo(this.asked!);
        this.asked = undefined;
        moved();
      });
    });
    label.append(slider);
    place.append(label, this.told);
    this.show();
  }

  show(): void {
    const { rig, slider, told } = this;
    const { run, sample, data } = rig;
    Object.assign(slider, { min: String(run.history.first + 1), max: String(run.history.count), disabled: run.history.count < 2 });
    slider.value = String(sample);
    const time = timeText(sample * data.period);
    slider.setAttribute("aria-valuetext", time);
    const isPast = sample < run.history.count;
    const text = isPast ? `${time} of ${timeText(run.history.count * data.period)}; ${this.then}` : "";
    if (told.textContent !== text) told.textContent = text;
  }
}
