/** What the page carries as JSON beside its words. */

/** One line of a panel, a value for each time. */
export interface Curve {
  name: string;
  colour: string;
  dashed: boolean;
  values: number[];
}

/** Curves that share an axis. */
export interface Panel {
  unit: string;
  curves: Curve[];
}

/** A run: panels above each other on one time axis. */
export interface Trends {
  unit: string;
  time: number[];
  panels: Panel[];
}

/** Return the run that the page carries, if it has one. */
export function trends(): Trends | undefined {
  const text = document.getElementById("trends")?.textContent;
  return text ? (JSON.parse(text) as Trends) : undefined;
}
