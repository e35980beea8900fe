/** Trends that scroll: each controlled variable with its setpoint, and each input of the process. */

import uPlot from "uplot";

import { axisStyle } from "../axes";
import { onLook } from "../look";
import { colour } from "../shown";
import { numberText, timeUnit } from "../words";
import type { LabData, ShownSignal } from "./data.ts";
import { element } from "./faceplates.ts";
import type { History } from "./history.ts";
import type { Rig } from "./rig.ts";

const HEIGHT = 120;
/** Points of a curve, at most. */
const MOST = 800;
/** Times that are seen [s]: of these, those that are this many samples, and at first the nearest to so many. */
const WINDOWS = [10, 60, 300, 900, 3600, 4 * 3600, 12 * 3600, 86_400, 3 * 86_400, 10 * 86_400, 60 * 86_400];
const [FEWEST, FIRST] = [100, 1000];

interface Trend {
  names: string[];
  signal: ShownSignal;
  canvas: HTMLElement;
  chart: uPlot;
}

export class Trends {
  private readonly place: HTMLElement;
  private readonly rig: Rig;
  private readonly history: History;
  private readonly signals: Map<string, ShownSignal>;
  /** In samples. */
  private readonly windows: number[];
  private window: number;
  private trends: Trend[] = [];

  constructor(place: HTMLElement, rig: Rig, history: History, signals: Map<string, ShownSignal>) {
    this.place = place;
    this.rig = rig;
    this.history = history;
    this.signals = signals;
    const all = WINDOWS.map((seconds) => Math.round(seconds / rig.data.period));
    this.windows = all.filter((samples) => samples >= FEWEST && samples <= history.capacity);
    this.window = this.windows.reduce((best, each) => (away(each) < away(best) ? each : best));
    this.build();
    onLook(() => this.build());
    new ResizeObserver(() => this.resize()).observe(place);
  }

  /** Draw what was, up to now. */
  show(): void {
    const { period } = this.rig.data;
    const [, length] = timeUnit(this.window * period);
    const first = (Math.max(0, this.rig.samples - this.window) * period) / length;
    for (const { chart, names, signal } of this.trends) {
      const { samples, values } = this.history.last(this.window, MOST, names);
      const times = samples.map((sample) => (sample * period) / length);
      const shown = values.map((curve) => curve.map((value) => value * signal.factor));
      chart.setData([times, ...shown] as uPlot.AlignedData, false);
      chart.batch(() => {
        chart.setScale("x", { min: first, max: first + (this.window * period) / length });
        chart.setScale("y", span(shown, signal));
      });
    }
  }

  private build(): void {
    for (const { chart } of this.trends) chart.destroy();
    this.place.replaceChildren(this.choice());
    const { controlled, inputs }: LabData = this.rig.data;
    this.trends = [
      ...controlled.map((name) => this.trend(name, [name, `${name}.setpoint`])),
      ...inputs.map((name) => this.trend(name, [name])),
    ];
    this.show();
  }

  private choice(): HTMLElement {
    const label = element("label", "window", "Trends over ");
    const select = element("select", "");
    for (const samples of this.windows) {
      const seconds = samples * this.rig.data.period;
      const [unit, length] = timeUnit(seconds);
      const option = element("option", "", `${numberText(seconds / length, 3)} ${unit}`);
      option.value = String(samples);
      option.selected = samples === this.window;
      select.append(option);
    }
    select.addEventListener("change", () => {
      this.window = Number(select.value);
      this.show();
    });
    label.append(select);
    return label;
  }

  private trend(name: string, names: string[]): Trend {
    const signal = this.signals.get(name)!;
    const figure = element("figure", "trend");
    const canvas = element("div", "");
    canvas.setAttribute("role", "img");
    const follows = names.length > 1 ? ", its setpoint dashed" : "";
    const unit = signal.unit ? ` [${signal.unit}]` : "";
    canvas.setAttribute("aria-label", `${name}${unit} over time${follows}`);
    figure.append(element("figcaption", "", `${name}${unit}${follows}`), canvas);
    this.place.append(figure);
    const [word] = timeUnit(this.window * this.rig.data.period);
    const axis = axisStyle();
    const chart = new uPlot({
      width: Math.max(200, canvas.clientWidth), height: HEIGHT,
      legend: { show: false }, cursor: { show: false }, padding: [6, 26, 0, 0],
      scales: { x: { time: false, auto: false }, y: { auto: false } },
      axes: [
        { ...axis, size: 22, space: 70, values: (_, splits) => splits.map((each, place) => numberText(each, 5) + (place === splits.length - 1 ? ` ${word}` : "")) },
        { ...axis, size: 52, space: 28, values: (_, splits) => splits.map((each) => numberText(each, 5)) },
      ],
      series: [
        {},
        ...names.map((each) => ({
          stroke: colour(each === name ? "--curve-0" : "--ink"), width: each === name ? 1.6 : 1.2,
          dash: each === name ? [] : [5, 4], points: { show: false },
        })),
      ],
    }, names.reduce<number[][]>((data) => [...data, []], [[]]) as uPlot.AlignedData, canvas);
    return { names, signal, canvas, chart };
  }

  private resize(): void {
    for (const { chart, canvas } of this.trends) {
      const width = canvas.clientWidth;
      if (width && width !== chart.width) chart.setSize({ width, height: HEIGHT });
    }
  }
}

/** Return how far a window is from the first one that is shown. */
const away = (samples: number): number => Math.abs(Math.log(samples / FIRST));

/** What a trend spans at least, as a share of the signal's range: less is no motion that one would see. */
const LEAST = 0.02;

/** Return from where to where curves go, with room around them. */
function span(curves: number[][], signal: ShownSignal): { min: number; max: number } {
  let [low, high] = [Infinity, -Infinity];
  for (const curve of curves)
    for (const value of curve) if (Number.isFinite(value)) [low, high] = [Math.min(low, value), Math.max(high, value)];
  if (low > high) return { min: 0, max: 1 };
  const whole = signal.low === null || signal.high === null ? 0 : (signal.high - signal.low) * signal.factor;
  const least = LEAST * (whole || Math.max(Math.abs(low), Math.abs(high), 1));
  const room = Math.max((high - low) * 0.1, (least - (high - low)) / 2);
  return { min: low - room, max: high + room };
}
