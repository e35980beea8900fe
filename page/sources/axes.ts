/** Logarithmic axes in the colours of the page, and the line of a limit. */

import type uPlot from "uplot";

import { colour } from "./shown";
import { numberText } from "./words";

const FONT = "12px system-ui, sans-serif";

/** Return the style that all axes have. */
export function axisStyle(): Partial<uPlot.Axis> {
  return {
    stroke: colour("--muted"), font: FONT, labelFont: FONT, labelSize: 18,
    grid: { stroke: colour("--grid"), width: 1 }, ticks: { show: false },
  };
}

/** Return the multiples of a step between two numbers. */
export function multiples(low: number, high: number, step: number): number[] {
  const [first, last] = [Math.ceil(low / step - 1e-6), Math.floor(high / step + 1e-6)];
  return Array.from({ length: Math.max(0, last - first + 1) }, (_, place) => (first + place) * step);
}

/** Return an axis with a label whose numbers stand where `ticks` has them. */
export function logAxis(label: string, size: number, ticks: (low: number, high: number) => number[]): uPlot.Axis {
  return {
    ...axisStyle(), label, size,
    splits: (_, __, low, high) => ticks(low, high),
    filter: (_, splits) => splits,
    values: (_, splits) => splits.map((each) => numberText(each, 2)),
  };
}

/** Return multiples of powers of ten between two numbers. */
export function decades(low: number, high: number, factors: number[]): number[] {
  const [first, last] = [Math.floor(Math.log10(low)), Math.ceil(Math.log10(high))];
  const found: number[] = [];
  for (let power = first; power <= last; power += 1) found.push(...factors.map((each) => each * 10 ** power));
  return found.filter((each) => each >= 0.999 * low && each <= 1.001 * high);
}

/** Draw a limit across the chart at a value of an axis, in a colour that no curve has. */
export function limitLine(chart: uPlot, axis: "x" | "y", limit: number): void {
  const { ctx, bbox } = chart;
  const place = Math.floor(chart.valToPos(limit, axis, true)) + 0.5;
  const start = axis === "x" ? bbox.left : bbox.top;
  if (place < start || place > start + (axis === "x" ? bbox.width : bbox.height)) return;
  ctx.save();
  ctx.strokeStyle = colour("--ink");
  ctx.beginPath();
  if (axis === "x") {
    ctx.moveTo(place, bbox.top);
    ctx.lineTo(place, bbox.top + bbox.height);
  } else {
    ctx.moveTo(bbox.left, place);
    ctx.lineTo(bbox.left + bbox.width, place);
  }
  ctx.stroke();
  ctx.restore();
}
