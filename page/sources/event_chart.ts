/** One signal after one event: a curve for each controller that is shown. */

import uPlot from "uplot";

import { axisStyle, decades, limitLine, multiples } from "./axes";
import type { Controller, Signal } from "./data";
import { colour, type Shown } from "./shown";
import { differenceText, numberText, timeText, timeUnit } from "./words";

const HEIGHT = 94;
const AXIS = 20;
/** What a chart leaves free above and below its curves, as a share of what they span. */
const MARGIN = 0.1;

/** Steps between the marks of a signal. */
const STEPS = decades(1e-12, 1e12, [1, 2, 2.5, 5]);
/** Return a mark of an axis with all its digits, however close the next one is. */
const markText = (value: number): string => numberText(value, 9);

/** Null where there is no number. */
export type Curve = (number | null)[];

export interface Curves {
  signal: Signal;
  /** Seconds after the event. */
  times: number[];
  /** By controller; one that has none here is left out. */
  values: (Curve | undefined)[];
  /** One that all controllers follow, or one for each. */
  setpoints: (Curve | null)[];
}

/** What the charts of a page have in common. */
export interface Common {
  shown: Shown;
  controllers: Controller[];
  /** The time from which differences are told. */
  mark: number | null;
  setMark(time: number | null): void;
}

export class EventChart {
  readonly place = document.createElement("div");
  private readonly readout = document.createElement("p");
  private readonly canvas = document.createElement("div");
  private chart: uPlot | undefined;
  /** Whether it can be seen, and whether it then is to be drawn with other curves. */
  private seen = false;
  private stale = false;

  constructor(
    readonly curves: Curves,
    private readonly common: Common,
    title: string,
    /** Where the time at the cursor stands, once for all charts of the event. */
    private readonly when: HTMLElement,
    private readonly last: boolean,
    private range: [number, number],
    /** Asks that all charts of the event show these times, or again what they showed at first. */
    private readonly zoom: (range: [number, number] | null) => void,
    /** The least that the axis spans. */
    private readonly least: () => number,
  ) {
    const { name, unit } = curves.signal;
    this.place.className = "chart";
    this.readout.className = "readout";
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("role", "img");
    const label = `${name}${unit ? ` in ${unit}` : ""} after ${title}`;
    this.canvas.setAttribute("aria-label", `${label}; arrow keys move the cursor, Enter marks a time`);
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    this.place.append(this.readout, this.canvas);
    new IntersectionObserver(([entry]) => {
      this.seen = entry!.isIntersecting;
      this.refresh();
    }).observe(this.place);
  }

  /** Take another curve of a controller, which the next `refresh` draws. */
  take(controller: number, curve: Curve | undefined): void {
    this.curves.values[controller] = curve;
    this.stale = true;
  }

  /** Draw the curves that were taken, as soon as the chart is seen; it is not built anew. */
  refresh(): void {
    if (!this.seen || !this.stale || !this.chart) return;
    this.stale = false;
    this.chart.setData(this.data());
    this.tell();
  }

  /** Draw it anew, with the controllers that are shown now. */
  draw(): void {
    this.chart?.destroy();
    const { signal } = this.curves;
    const controllers = this.common.shown.controllers;
    // The lines that its values may take, lest the chart move under the mouse when they come.
    this.readout.style.minHeight = `${1.05 * Math.ceil(controllers.length / 2)}rem`;
    const paths = signal.held ? { paths: uPlot.paths.stepped!({ align: 1 }) } : {};
    const series: uPlot.Series[] = [
      {},
      ...this.wanted().map(([, property]) => ({
        stroke: colour(property), width: 1, dash: [4, 3], points: { show: false },
        paths: uPlot.paths.stepped!({ align: 1 }),
      })),
      ...controllers.map((each) => ({
        stroke: colour(this.common.shown.property(each)), width: 1.6,
        dash: this.common.shown.dash(each), points: { show: false }, spanGaps: false, ...paths,
      })),
    ];
    this.chart = new uPlot(this.options(series), this.data(), this.canvas);
    this.stale = false;
    this.over(this.chart);
    this.tell();
  }

  /** Show other times. */
  show(range: [number, number]): void {
    this.range = range;
    this.chart?.setScale("x", { min: range[0], max: range[1] });
  }

  resize(): void {
    const width = this.canvas.clientWidth;
    if (this.chart && width) this.chart.setSize({ width, height: this.height });
  }

  redraw(): void {
    this.chart?.redraw(false);
    this.tell();
  }

  /** Return from where to where the curves go within the times that are shown. */
  span(): [number, number] {
    const [times, ...curves] = this.data();
    let [low, high] = this.curves.signal.band ?? [Infinity, -Infinity];
    for (const curve of curves)
      curve.forEach((value, place) => {
        const time = times[place]!;
        if (value === null || time < this.range[0] || time > this.range[1]) return;
        [low, high] = [Math.min(low, value), Math.max(high, value)];
      });
    return low <= high ? [low, high] : [0, 1];
  }

  /** Return times, setpoints and the curves that are shown. */
  private data(): [number[], ...Curve[]] {
    const { times, values } = this.curves;
    const own = this.common.shown.controllers.map((each) => values[each] ?? times.map(() => null));
    return [times, ...this.wanted().map(([curve]) => curve), ...own];
  }

  /** Return the setpoints that are shown, each with the property that holds its colour. */
  private wanted(): [Curve, string][] {
    const { setpoints } = this.curves;
    if (setpoints.length === 1) return setpoints[0] ? [[setpoints[0], "--muted"]] : [];
    const { shown } = this.common;
    return shown.controllers.flatMap((each): [Curve, string][] => {
      const own = setpoints[each];
      return own ? [[own, shown.property(each)]] : [];
    });
  }

  private get height(): number {
    return HEIGHT + (this.last ? AXIS : 0);
  }

  private options(series: uPlot.Series[]): uPlot.Options {
    const [unit, length] = timeUnit(this.range[1]);
    const axis: uPlot.Axis = { ...axisStyle(), splits: (_, __, low, high, step) => multiples(low, high, step) };
    const steps = [...decades(1e-3, 10, [1, 2, 5]), 15, 20, 30, 60, 100, 120, 150, 200, 300, 500, 600];
    return {
      width: this.canvas.clientWidth || 400,
      height: this.height,
      legend: { show: false },
      padding: [7, 26, this.last ? 0 : 4, 0],
      scales: {
        x: { time: false, range: () => this.range },
        y: { range: () => this.bounds() },
      },
      axes: [
        {
          ...axis, size: this.last ? AXIS : 0, show: this.last, space: 60, gap: 2,
          incrs: steps.map((each) => each * length),
          values: (_, splits) =>
            splits.map((each, place) => markText(each / length) + (place === splits.length - 1 ? ` ${unit}` : "")),
        },
        { ...axis, size: 46, space: 20, gap: 3, incrs: STEPS, values: (_, splits) => splits.map(markText) },
      ],
      cursor: {
        sync: { key: "events", scales: ["x", null] },
        // What is a click, `over` decides: to uPlot it is a drag already where the page moved under it.
        drag: { x: true, y: false, setScale: false, click: () => undefined },
        points: { size: 6 },
        bind: { dblclick: () => () => (this.zoom(null), null) },
      },
      hooks: {
        drawAxes: [(chart) => this.limits(chart)],
        draw: [(chart) => this.lines(chart)],
        setCursor: [() => this.tell()],
        setSelect: [(chart) => this.selected(chart)],
      },
      series,
    };
  }

  /** Return the ends of the axis: the curves, and not so little that rounding looks like motion. */
  private bounds(): [number, number] {
    let [low, high] = this.span();
    const missing = this.least() - (high - low);
    if (missing > 0) [low, high] = [low - missing / 2, high + missing / 2];
    const margin = MARGIN * (high - low);
    return [low - margin, high + margin];
  }

  /** Shade what lies beyond the limits of the signal, and draw the ends of its band. */
  private limits(u: uPlot): void {
    const { ctx, bbox } = u;
    const { low, high, band } = this.curves.signal;
    const [bottom, top] = [bbox.top + bbox.height, bbox.top];
    ctx.save();
    ctx.fillStyle = colour("--beyond");
    ctx.strokeStyle = colour("--muted");
    for (const [limit, edge] of [[high, top], [low, bottom]] as const) {
      if (limit === null) continue;
      const y = u.valToPos(limit, "y", true);
      if (y < top || y > bottom) continue;
      ctx.fillRect(bbox.left, Math.min(y, edge), bbox.width, Math.abs(y - edge));
      ctx.beginPath();
      ctx.moveTo(bbox.left, y);
      ctx.lineTo(bbox.left + bbox.width, y);
      ctx.stroke();
    }
    ctx.restore();
    for (const end of band ?? []) limitLine(u, "y", end);
  }

  /** Draw when the event is, and the mark. */
  private lines(u: uPlot): void {
    const { ctx, bbox } = u;
    ctx.save();
    for (const [time, property] of [[0, "--muted"], [this.common.mark, "--ink"]] as const) {
      if (time === null) continue;
      const x = u.valToPos(time, "x", true);
      if (x < bbox.left || x > bbox.left + bbox.width) continue;
      ctx.strokeStyle = colour(property);
      ctx.globalAlpha = time === 0 ? 0.5 : 1;
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
    }
    ctx.restore();
  }

  private selected(u: uPlot): void {
    const { left, width } = u.select;
    if (width < 8) return;
    this.zoom([u.posToVal(left, "x"), u.posToVal(left + width, "x")]);
    u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
  }

  /** A click marks a time, and a click on the mark takes it away. */
  private over(u: uPlot): void {
    let from = 0;
    u.over.addEventListener("mousedown", (event) => (from = event.clientX));
    u.over.addEventListener("click", (event) => {
      if (Math.abs(event.clientX - from) > 4 || event.detail > 1) return;
      this.markAt(u, event.clientX - u.over.getBoundingClientRect().left);
    });
  }

  private markAt(u: uPlot, left: number): void {
    const time = u.posToVal(left, "x");
    const { mark } = this.common;
    const near = mark !== null && Math.abs(u.valToPos(mark, "x") - u.valToPos(time, "x")) < 6;
    this.common.setMark(near ? null : time);
  }

  private key(event: KeyboardEvent): void {
    const u = this.chart;
    if (!u) return;
    const width = u.over.clientWidth;
    const left = (u.cursor.left ?? -1) < 0 ? u.valToPos(0, "x") : u.cursor.left!;
    const step = event.shiftKey ? 20 : 2;
    const [low, high] = this.range;
    const middle = u.posToVal(left, "x");
    const around = (factor: number): [number, number] => [
      middle - (middle - low) * factor,
      middle + (high - middle) * factor,
    ];
    const actions: Record<string, () => void> = {
      ArrowLeft: () => u.setCursor({ left: Math.max(0, left - step), top: 10 }),
      ArrowRight: () => u.setCursor({ left: Math.min(width, left + step), top: 10 }),
      Enter: () => this.markAt(u, left),
      Escape: () => (this.common.setMark(null), this.zoom(null)),
      "+": () => this.zoom(around(0.5)),
      "-": () => this.zoom(around(2)),
    };
    const action = actions[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  }

  /** Tell the values at the cursor, and how they differ from those at the mark. */
  private tell(): void {
    const { name, unit } = this.curves.signal;
    const title = document.createElement("b");
    title.textContent = unit ? `${name} [${unit}]` : name;
    this.readout.replaceChildren(title);
    const left = this.chart?.cursor.left ?? -1;
    this.when.textContent = "";
    if (!this.chart || left < 0) return;
    const time = this.chart.posToVal(left, "x");
    const { mark, shown, controllers } = this.common;
    this.when.textContent = mark === null ? timeText(time) : `${timeText(time)} (${timeText(time - mark, "+")})`;
    for (const controller of shown.controllers) {
      const curve = this.curves.values[controller];
      const value = curve ? this.at(curve, time) : null;
      if (!curve || value === null) continue;
      const before = mark === null ? null : this.at(curve, mark);
      const words = document.createElement("span");
      words.title = controllers[controller]!.title;
      shown.paint(words, controller);
      const difference = before === null ? "" : ` (${differenceText(value - before)})`;
      words.textContent = numberText(value) + difference;
      this.readout.append(words);
    }
  }

  /** Return the value of a curve at a time, level or on a line between points. */
  private at(curve: Curve, time: number): number | null {
    const { times, signal } = this.curves;
    const next = times.findIndex((each) => each > time);
    if (next <= 0) return curve[next < 0 ? curve.length - 1 : 0] ?? null;
    const [a, b] = [curve[next - 1] ?? null, curve[next] ?? null];
    if (a === null || b === null || signal.held) return a;
    const [from, to] = [times[next - 1]!, times[next]!];
    return a + ((b - a) * (time - from)) / (to - from);
  }
}
