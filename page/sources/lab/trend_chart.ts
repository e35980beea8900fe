/** One trend: a signal, what it is asked to be, and the same signal of other runs. */

import uPlot from "uplot";

import { axisStyle, decades } from "../axes";
import { colour } from "../shown";
import { numberText, timeUnit } from "../words";
import type { ShownSignal } from "./data.ts";
import { element } from "./faceplates.ts";
import type { Marks } from "./marks.ts";
import { panelText } from "./quantities.ts";
import type { View } from "./view.ts";

const HEIGHT = 140;
/** What a trend spans at least, as a share of the signal's range: less is no motion that one would see. */
const LEAST = 0.02;
/** Marks that are nearer to each other are one [px]. */
const APART = 3;
const CURSORS = ["A", "B"];

/** A curve of SI values. */
export interface Curve {
  values: number[];
  /** The property that holds its colour. */
  property: string;
  kind: "own" | "setpoint" | "other";
}

/** What all trends show together. */
export interface Shown {
  view: View;
  period: number;
  samples: number[];
  marks: Marks;
  /** Where the rig stands, if its run goes on from there. */
  standing: number | undefined;
}

export class TrendChart {
  readonly place = element("figure", "trend");
  readonly canvas = element("div", "");
  readonly chart: uPlot;
  readonly signal: ShownSignal;
  private readonly caption: string;
  private readonly number = element("span", "number", "");
  private shown: Shown | undefined;

  constructor(place: HTMLElement, signal: ShownSignal, curves: Pick<Curve, "property" | "kind">[], isHeld: boolean, save: () => void) {
    this.signal = signal;
    const { name, unit } = signal;
    const dashed = curves.some(({ kind }) => kind === "setpoint") ? ", its setpoint dashed" : "";
    this.caption = `${name}${unit ? ` [${unit}]` : ""}${dashed}`;
    const caption = element("figcaption", "");
    const button = element("button", "picture", "PNG");
    button.setAttribute("aria-label", `PNG of the trend of ${name}`);
    button.addEventListener("click", save);
    caption.append(element("span", "", this.caption), this.number, button);
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("role", "img");
    const keys = "a and b set cursors, arrow keys move them, plus and minus zoom, page keys scroll";
    this.canvas.setAttribute("aria-label", `${this.caption}, over time; ${keys}`);
    this.place.append(caption, this.canvas);
    place.append(this.place);
    this.chart = new uPlot(this.options(curves, isHeld), [[], ...curves.map(() => [])], this.canvas);
  }

  get title(): string {
    return this.caption;
  }

  /** Draw curves over the samples that all trends show. */
  show(shown: Shown, curves: Curve[]): void {
    this.shown = shown;
    const { view, period, samples } = shown;
    const { factor } = this.signal;
    const values = curves.map((curve) => curve.values.map((value) => (Number.isNaN(value) ? null : value * factor)));
    this.chart.setData([samples.map((sample) => sample * period), ...values] as uPlot.AlignedData, false);
    this.chart.batch(() => {
      this.chart.setScale("x", { min: view.first * period, max: view.last * period });
      this.chart.setScale("y", span(values, this.signal));
    });
  }

  resize(): void {
    const width = this.canvas.clientWidth;
    if (width && width !== this.chart.width) this.chart.setSize({ width, height: HEIGHT });
  }

  private options(curves: Pick<Curve, "property" | "kind">[], isHeld: boolean): uPlot.Options {
    const axis = axisStyle();
    const steps = [...decades(1e-3, 1e7, [1, 2, 5])];
    const unit = (): [string, number] => timeUnit((this.shown?.view.length ?? 0) * (this.shown?.period ?? 1));
    const stepped = uPlot.paths.stepped!({ align: 1 });
    return {
      width: Math.max(200, this.canvas.clientWidth), height: HEIGHT, padding: [14, 26, 0, 0],
      legend: { show: false },
      scales: { x: { time: false, auto: false }, y: { auto: false } },
      axes: [
        {
          ...axis, size: 22, space: 70,
          incrs: () => steps.map((each) => each * unit()[1]),
          values: (_, splits) => splits.map((each, place) => numberText(each / unit()[1], 9) + (place === splits.length - 1 ? ` ${unit()[0]}` : "")),
        },
        { ...axis, size: 52, space: 24, values: (_, splits) => splits.map((each) => numberText(each, 6)) },
      ],
      cursor: {
        sync: { key: "trends", scales: ["x", null] }, drag: { x: false, y: false }, y: false,
        points: { size: 6 }, bind: { dblclick: () => () => null },
      },
      hooks: {
        drawAxes: [(chart) => this.drawMarks(chart)], draw: [(chart) => this.drawCursors(chart)],
        setCursor: [() => this.tell()],
      },
      series: [
        {},
        ...curves.map(({ property, kind }) => ({
          stroke: colour(property), width: kind === "own" ? 1.6 : 1.2, dash: kind === "setpoint" ? [5, 4] : [],
          points: { show: false }, pxAlign: 0, ...(isHeld || kind === "setpoint" ? { paths: stepped } : {}),
        })),
      ],
    };
  }

  /** Tell the value at the mouse. */
  private tell(): void {
    const { idx } = this.chart.cursor;
    const value = idx === null || idx === undefined ? null : this.chart.data[1]![idx];
    const text = value === null || value === undefined ? "" : panelText(this.signal, value / this.signal.factor);
    if (this.number.textContent !== text) this.number.textContent = text;
  }

  private drawMarks(chart: uPlot): void {
    if (!this.shown) return;
    const { view, marks, period } = this.shown;
    const apart = (APART * devicePixelRatio * view.length) / Math.max(1, chart.bbox.width);
    for (const { sample, isAbnormal } of marks.places(view.first, view.last, apart)) {
      const x = chart.valToPos(sample * period, "x", true);
      vertical(chart, x, colour(isAbnormal ? "--alarm" : "--muted"), isAbnormal ? 0.9 : 0.45, [2, 3]);
    }
  }

  private drawCursors(chart: uPlot): void {
    if (!this.shown) return;
    const { view, period, standing } = this.shown;
    if (standing !== undefined) vertical(chart, chart.valToPos(standing * period, "x", true), colour("--link"), 1, []);
    view.cursors.forEach((sample, place) => {
      const x = chart.valToPos(sample * period, "x", true);
      if (!vertical(chart, x, colour("--ink"), 1, [])) return;
      const { ctx, bbox } = chart;
      ctx.save();
      ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
      ctx.textAlign = "center";
      ctx.fillStyle = colour("--ink");
      ctx.fillText(CURSORS[place]!, x, bbox.top - 3 * devicePixelRatio);
      ctx.restore();
    });
  }
}

/** Draw a line from top to bottom, if it can be seen there, and return whether it can. */
function vertical(chart: uPlot, x: number, stroke: string, alpha: number, dash: number[]): boolean {
  const { ctx, bbox } = chart;
  if (!(x >= bbox.left && x <= bbox.left + bbox.width)) return false;
  ctx.save();
  ctx.strokeStyle = stroke;
  ctx.globalAlpha = alpha;
  ctx.lineWidth = devicePixelRatio;
  ctx.setLineDash(dash.map((each) => each * devicePixelRatio));
  ctx.beginPath();
  ctx.moveTo(Math.floor(x) + 0.5, bbox.top);
  ctx.lineTo(Math.floor(x) + 0.5, bbox.top + bbox.height);
  ctx.stroke();
  ctx.restore();
  return true;
}

/** Return from where to where curves go, with room around them. */
function span(curves: (number | null)[][], signal: ShownSignal): { min: number; max: number } {
  let [low, high] = [Infinity, -Infinity];
  for (const curve of curves)
    for (const value of curve) if (value !== null && Number.isFinite(value)) [low, high] = [Math.min(low, value), Math.max(high, value)];
  if (low > high) return { min: 0, max: 1 };
  const whole = signal.low === null || signal.high === null ? 0 : (signal.high - signal.low) * signal.factor;
  const least = LEAST * (whole || Math.max(Math.abs(low), Math.abs(high), 1));
  const room = Math.max((high - low) * 0.1, (least - (high - low)) / 2);
  return { min: low - room, max: high + room };
}
