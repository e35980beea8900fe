/** The numbers of the ranking: those of `report/figures.py` and `studies/judge.py`. */

import type { LiveColumn, Multiple } from "./messages.ts";

/** Return the number of each column; NaN for none, and for a peak, which no score tells. */
export function columnNumbers(columns: LiveColumn[], scores: number[]): number[] {
  return columns.map((column) => {
    switch (column.kind) {
      case "figure":
        return worst(column, scores);
      case "multiples":
        return relative(column, scores);
      case "peak":
        return NaN;
    }
  });
}

function worst({ parts }: LiveColumn, scores: number[]): number {
  const found = parts
    .map(({ score, scale }) => scores[score]! * scale)
    .filter((value) => !Number.isNaN(value));
  return found.length ? Math.max(...found) : NaN;
}

function relative({ groups, least }: LiveColumn, scores: number[]): number {
  const found = mean(
    groups.map((group) =>
      mean(group.map((part) => multiple(part, part.score === null ? NaN : scores[part.score]!))),
    ),
  );
  return found === least ? 1 : found / least;
}

/** Return a score as a multiple of the best, of which a little counts as nothing. */
function multiple({ best, smallest, less }: Multiple, value: number): number {
  if (!Number.isFinite(value)) return Infinity;
  if (best === null) return 1;
  const [better, worse] = less ? [best, value] : [value, best];
  const beside = Math.max(better, smallest);
  if (beside === 0) return worse === 0 ? 1 : Infinity;
  return Math.max(worse, smallest) / beside;
}

function mean(values: number[]): number {
  return values.reduce((sum, value) => sum + value, 0) / values.length;
}
