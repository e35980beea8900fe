/** The log as it is shown: a line each, the latest above. */

import type { PlantData } from "./data.ts";
import { element } from "./faceplates.ts";
import { Log } from "./log.ts";
import { momentText } from "./quantities.ts";
import type { Run } from "./run.ts";

export class Happened {
  private readonly list = element("ol", "");
  private readonly log: Log;
  private readonly period: number;
  private shown = -1;

  constructor(place: HTMLElement, data: PlantData, titled: (controller: string) => string) {
    this.log = new Log(data, titled);
    this.period = data.period;
    // Who reads by keyboard scrolls it.
    this.list.tabIndex = 0;
    this.list.setAttribute("aria-label", "What happened, the latest first");
    place.append(element("h2", "", "What happened"), this.list);
  }

  /** Tell what happened in a run up to a sample. */
  show(run: Run, sample: number): void {
    this.log.read(run, sample);
    if (this.log.version === this.shown) return;
    this.shown = this.log.version;
    const lines = this.log.latest.map(({ words, isAbnormal, first, sample: last, times }) => {
      const line = element("li", isAbnormal ? "abnormal" : "");
      line.append(element("span", "when", this.span(first, last)), element("span", "words", words));
      if (times > 1) line.append(element("span", "times", `${times} times`));
      return line;
    });
    const nothing = element("li", "nothing", "Your actions, trips, overflows, limits and faults appear here.");
    this.list.replaceChildren(...(lines.length ? lines : [nothing]));
  }

  private span(first: number, last: number): string {
    const [from, to] = [first, last].map((sample) => momentText(sample, this.period));
    return from === to ? to! : `${from} to ${to}`;
  }
}
