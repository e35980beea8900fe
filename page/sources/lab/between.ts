/** What is between the cursors: values at both, and scores, as a table. */

import { numberText, timeText } from "../words";
import type { PlantData, ShownSignal, Touch } from "./data.ts";
import { element } from "./faceplates.ts";
import { shownText } from "./quantities.ts";
import { inControl } from "./in_control.ts";
import { BAND, controlledScores, totalVariation } from "./scores_between.ts";
import type { Past } from "./thinned.ts";

const HEADS = ["signal", "run and its controllers", "at A", "at B", "IAE", "overshoot of the step", `settles within ${100 * BAND} %`, "total variation"];

/** A run as its scores see it. */
export interface ScoredRun {
  name: string;
  history: Past;
  touches: Touch[];
  titles: Record<string, string>;
}

export class Between {
  readonly place = element("div", "between");
  private readonly data: PlantData;
  private readonly signals: Map<string, ShownSignal>;
  private readonly words = element("p", "", "");
  private readonly table = element("table", "");
  private told = "";

  constructor(data: PlantData, signals: Map<string, ShownSignal>) {
    this.data = data;
    this.signals = signals;
    const wide = element("div", "wide");
    wide.tabIndex = 0;
    wide.setAttribute("role", "region");
    wide.setAttribute("aria-label", "Scores between the cursors");
    wide.append(this.table);
    this.place.append(this.words, wide);
    this.place.hidden = true;
  }

  /** Show what there is of the cursors A and B in some runs; one that only goes on changes nothing between them. */
  show(runs: ScoredRun[], cursors: readonly number[]): void {
    this.place.hidden = cursors.length === 0;
    const [a, b] = cursors;
    if (a === undefined) return;
    const { period, controlled, inputs } = this.data;
    const times = cursors.map((sample, place) => `${"AB"[place]} at ${timeText(sample * period, "", 5)}`);
    if (b !== undefined) times.push(`${timeText(Math.abs(b - a) * period, "", 5)} between them`);
    this.words.textContent = times.join(", ");
    const known = runs.map(({ name, history, touches }) => [name, touches.length, history.count > Math.max(a, b ?? a)]);
    const key = JSON.stringify([a, b, known]);
    if (key === this.told) return;
    this.told = key;
    const rows = [...controlled, ...inputs].flatMap((name) =>
      runs.map((run) => row([name, this.runWords(run, a, b), ...this.cells(run, this.signals.get(name)!, a, b)], "td")),
    );
    const [top, body] = [element("thead", ""), element("tbody", "")];
    top.append(row(HEADS, "th"));
    body.append(...rows);
    this.table.replaceChildren(top, body);
  }

  /** Ask for the scores anew, as of another run. */
  forget(): void {
    this.told = "";
  }

  private runWords(run: ScoredRun, a: number, b = a): string {
    const titles = inControl(run, this.data.controllers, Math.min(a, b), Math.max(a, b));
    return `${run.name}: ${titles.join(", then ")}`;
  }

  private cells({ history, touches }: ScoredRun, signal: ShownSignal, a: number, b: number | undefined): string[] {
    const at = (sample: number | undefined): string =>
      sample === undefined ? "" : shownText(signal, history.values(signal.name, sample, sample + 1)[0]!);
    const ends = b === undefined || a === b || Math.max(a, b) >= history.count ? undefined : [Math.min(a, b), Math.max(a, b)] as const;
    return [at(a), at(b), ...(ends ? this.scores(history, touches, signal, ...ends) : ["", "", "", ""])];
  }

  private scores(past: Past, touches: Touch[], signal: ShownSignal, first: number, last: number): string[] {
    const { name, unit, factor } = signal;
    if (!this.data.controlled.includes(name)) {
      const moved = totalVariation(past.values(name, first, last + 1));
      return ["", "", "", quantity(moved * factor, unit)];
    }
    const setpoint = past.values(`${name}.setpoint`, first, last + 1);
    const before = past.values(`${name}.setpoint`, first - 1, first)[0]!;
    const within = touches.map(({ sample }) => sample - first).filter((place) => place >= 0 && place < setpoint.length);
    const output = past.values(`${name}.true`, first, last + 1);
    const { iae, overshoot, settling } = controlledScores(
      setpoint, output, Number.isNaN(before) ? setpoint[0]! : before, within, this.data.period,
    );
    return [
      quantity(iae * factor, unit ? `${unit} s` : "s"), quantity(overshoot, "%"),
      Number.isNaN(settling) ? "–" : settling === Infinity ? "not within" : timeText(settling, "", 3), "",
    ];
  }
}

/** Return a row with its head. */
function row(words: string[], kind: "td" | "th"): HTMLTableRowElement {
  const found = element("tr", "");
  words.forEach((each, place) => {
    const cell = element(place ? kind : "th", "", each);
    if (cell.tagName === "TH") cell.scope = kind === "th" ? "col" : "row";
    found.append(cell);
  });
  return found;
}

function quantity(value: number, unit: string): string {
  if (Number.isNaN(value)) return "–";
  return value === Infinity ? "∞" : `${numberText(value, 4)}${unit ? ` ${unit}` : ""}`;
}
