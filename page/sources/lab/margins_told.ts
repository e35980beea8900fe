/** What a reader is told of a loop before it is switched on. */

import { PEAK_LIMIT } from "../data.ts";
import { marginTexts } from "../live/told.ts";
import { numberText, roundedText } from "../words.ts";
import { element } from "./faceplates.ts";
import type { LoopMargins, Rate } from "./loop_margins.ts";

/** Return what is told of a loop; null is one of which nothing is known. */
export function marginsTold(found: LoopMargins | null, look: string): HTMLElement[] {
  if (!found) return [element("p", "note", "This process has no linear model in the page, so margins are not shown.")];
  if (!found.isStable) {
    const warning = element("p", "watch", `The loop is unstable at the operating point: check ${look}.`);
    warning.setAttribute("role", "alert");
    return [warning];
  }
  const words = `The sampled loop is stable; max|S| is ${roundedText(found.peak, 3)}`;
  const isThin = found.peak > PEAK_LIMIT;
  const line = element("p", isThin ? "watch" : "", isThin ? `${words}, above ${PEAK_LIMIT}: thin margins.` : `${words}.`);
  const table = element("table", "margins");
  const head = ["loop opened at", "crossover", "gain margin", "phase margin", "delay margin"];
  const headRow = element("tr", "");
  headRow.append(...head.map((each) => element("th", "", each)));
  const top = element("thead", "");
  top.append(headRow);
  const body = element("tbody", "");
  for (const margins of found.margins) {
    const row = element("tr", "");
    const crossover = Number.isFinite(margins.crossover) ? `${roundedText(margins.crossover, 3)} rad/s` : "none";
    row.append(element("th", "", margins.name), ...[crossover, ...marginTexts(margins)].map((each) => element("td", "", each)));
    body.append(row);
  }
  table.append(top, body);
  const wide = element("div", "wide");
  wide.tabIndex = 0;
  wide.append(table);
  return [line, wide];
}

/** Return the poles of a regulator in a sentence. */
export function polesText(rates: Rate[]): string {
  const still = rates.filter(({ kind }) => kind === "integrator").length;
  const moving = rates.filter(({ kind, imaginary }) => kind !== "integrator" && imaginary >= 0).map(rateText);
  const integrators = still ? [still === 1 ? "one integrator" : `${still} integrators`] : [];
  return `Its poles: ${[...integrators, ...moving].join(", ")}.`;
}

function rateText({ real, imaginary, kind }: Rate): string {
  const text = numberText(real, 3) + (imaginary > 0 ? ` ± ${numberText(imaginary, 3)}j` : "");
  return `${text} 1/s${kind === "grows" ? " (it grows)" : ""}`;
}
