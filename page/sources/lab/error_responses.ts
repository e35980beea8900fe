/** What a regulator asks for at an error, in the units of the page: so a wrong unit is seen. */

import { at } from "../live/matrices.ts";
import type { SampledSystem } from "../live/response.ts";
import { numberText, timeText } from "../words.ts";
import type { ShownSignal } from "./data.ts";
import { element } from "./faceplates.ts";

/** How long an error stays [s], and in how many samples. */
const [LASTING, FEWEST, MOST] = [60, 60, 5000];

/** Return how many samples an error stays: a minute of them, where these are neither few nor many. */
export function lastingSamples(period: number): number {
  return Math.min(MOST, Math.max(FEWEST, Math.round(LASTING / period)));
}

/**
 * Return what an output moves by at once, and after some samples of an error that stays.
 *
 * `system` goes from y − r to what is moved [SI]; `size` is that of the error, r − y [SI].
 */
export function errorResponse({ A, B, C, D }: SampledSystem, input: number, output: number, size: number, samples: number): [number, number] {
  const shown = (state: number[]): number =>
    state.reduce((sum, value, place) => sum + at(C, output, place) * value, -size * at(D, output, input));
  let state = Array.from({ length: A.rows }, () => 0);
  const first = shown(state);
  for (let passed = 0; passed < samples; passed += 1)
    state = state.map((_, row) => state.reduce((sum, value, column) => sum + at(A, row, column) * value, -size * at(B, row, input)));
  return [first, shown(state)];
}

/** Return a table of what an error of one unit of the page makes each output do. */
export function errorResponsesTold(system: SampledSystem, measured: ShownSignal[], moved: ShownSignal[], period: number): HTMLElement {
  const samples = lastingSamples(period);
  const table = element("table", "margins");
  const row = (cells: string[], head: "th" | "td"): HTMLElement => {
    const found = element("tr", "");
    found.append(...cells.map((each, place) => element(place ? head : "th", "", each)));
    return found;
  };
  const [top, body] = [element("thead", ""), element("tbody", "")];
  top.append(row(["setpoint above measurement by", "moves", "at once", `after ${timeText(samples * period)}`], "th"));
  measured.forEach((from, input) => moved.forEach((to, output) => {
    const found = errorResponse(system, input, output, 1 / from.factor, samples);
    if (found.every((each) => each === 0)) return;
    const told = found.map((each) => `${numberText(each * to.factor, 3)} ${to.unit}`.trim());
    body.append(row([`1 ${from.unit} of ${from.name}`.replace("  ", " "), to.name, ...told], "td"));
  }));
  table.append(top, body);
  const wide = element("div", "wide");
  wide.tabIndex = 0;
  wide.append(element("p", "", "Are these the right units? A loop in wrong units may well be stable. With these:"), table);
  return wide;
}
