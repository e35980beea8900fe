/** The events of the scenario side by side, each in its own time window, a chart a signal. */

import { decoded, type PageData, type ScenarioEvent } from "./data";
import { type Common, type Curve, EventChart } from "./event_chart";
import { onLook } from "./look";
import type { Shown } from "./shown";

/** A curve spans at least so much of the axis as beside the signal that moves most. */
const LEAST = 0.3;

/** Takes the curves of a controller, by event and signal. */
export type TakeCurves = (controller: number, curves: (Curve | undefined)[][]) => void;

export function drawEvents(place: HTMLElement, data: PageData, shown: Shown): TakeCurves {
  const charts: EventChart[] = [];
  const common: Common = {
    shown,
    controllers: data.controllers,
    mark: null,
    setMark(time) {
      common.mark = time;
      for (const chart of charts) chart.redraw();
    },
  };
  const grid = document.createElement("div");
  grid.className = "events";
  const repeated = folded("The same steps back");
  place.append(legend(data, shown), grid);
  for (const event of data.events) {
    const [section, own] = column(data, event, common);
    (event.again ? repeated.grid : grid).append(section);
    charts.push(...own);
  }
  if (repeated.grid.childElementCount) place.append(repeated.fold);
  place.hidden = false;
  const visible = () => charts.filter(({ place: { offsetParent } }) => offsetParent);
  const draw = () => visible().forEach((chart) => chart.draw());
  draw();
  shown.onChange(draw);
  repeated.fold.addEventListener("toggle", draw);
  onLook(draw);
  new ResizeObserver(() => visible().forEach((chart) => chart.resize())).observe(place);
  return (controller, curves) => {
    curves.flat().forEach((curve, place) => charts[place]!.take(controller, curve));
    for (const chart of charts) chart.refresh();
  };
}

function column(data: PageData, event: ScenarioEvent, common: Common): [HTMLElement, EventChart[]] {
  const section = document.createElement("section");
  const title = document.createElement("h3");
  const when = document.createElement("span");
  when.className = "when";
  title.textContent = event.title;
  section.append(title, when);
  const times = decoded(event.samples, event.period) as number[];
  const charts: EventChart[] = [];
  const zoom = (range: [number, number] | null) => {
    for (const chart of charts) chart.show(range ?? event.view);
  };
  data.signals.forEach((signal, row) => {
    const { step, curves, setpoints } = event.traces[row]!;
    const chart = new EventChart(
      {
        signal,
        times,
        values: curves.map((each) => decoded(each, step)),
        setpoints: setpoints.map((each) => each && decoded(each, step)),
      },
      common,
      event.title,
      when,
      row === data.signals.length - 1,
      event.view,
      zoom,
      () => leastSpan(chart, charts),
    );
    charts.push(chart);
    section.append(chart.place);
  });
  return [section, charts];
}

/** Return the least that an axis spans: a share of what the most moved signal of its kind does. */
function leastSpan(chart: EventChart, charts: EventChart[]): number {
  const range = ({ curves: { signal } }: EventChart) =>
    signal.low === null || signal.high === null ? null : signal.high - signal.low;
  const own = range(chart);
  if (own === null) return 1e-9;
  const moved = charts
    .filter((each) => each.curves.signal.held === chart.curves.signal.held)
    .map((each) => {
      const [low, high] = each.span();
      const whole = range(each);
      return whole === null ? 0 : (high - low) / whole;
    });
  return Math.max(LEAST * Math.max(...moved), 1e-6) * own;
}

function folded(words: string): { fold: HTMLDetailsElement; grid: HTMLElement } {
  const fold = document.createElement("details");
  const summary = document.createElement("summary");
  summary.textContent = words;
  const grid = document.createElement("div");
  grid.className = "events";
  fold.append(summary, grid);
  return { fold, grid };
}

/** Name the controllers beside their colours, and say what can be done. */
function legend(data: PageData, shown: Shown): HTMLElement {
  const line = document.createElement("p");
  line.className = "legend";
  const draw = () => {
    const entries = shown.controllers.map((controller) => {
      const entry = document.createElement("span");
      entry.textContent = data.controllers[controller]!.title;
      shown.paint(entry, controller);
      return entry;
    });
    const hint = document.createElement("span");
    hint.className = "hint";
    const bands = data.signals.some(({ band }) => band) ? ", ends of the band solid" : "";
    hint.textContent =
      `Setpoints dashed, limits shaded${bands}. Drag to zoom, double click to go back, click to measure from there.`;
    line.replaceChildren(...entries, hint);
  };
  draw();
  shown.onChange(draw);
  return line;
}
