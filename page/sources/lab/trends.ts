/** Trends of a run: each controlled variable with its setpoint, and each input of the process. */

import { onLook } from "../look";
import { numberText, timeText, timeUnit } from "../words";
import { Between } from "./between.ts";
import type { PlantData, ShownSignal, Touch } from "./data.ts";
import { element } from "./faceplates.ts";
import { fileStem, saveFile } from "./files.ts";
import { listen } from "./gestures.ts";
import { Marks } from "./marks.ts";
import { Identify } from "./identify.ts";
import { MoreTrends } from "./more_trends.ts";
import { pictureOf } from "./picture.ts";
import { csvOf, matOf } from "./recorder.ts";
import { gridOf, type Past, Thinned } from "./thinned.ts";
import { TouchWords } from "./touch_words.ts";
import { type Curve, type Shown, TrendChart } from "./trend_chart.ts";
import { View } from "./view.ts";
import type { Happening } from "./watches.ts";

/** Points of a curve, at most. */
const MOST = 1600;
/** Times that are seen [s]: of these, those that are this many samples; at first the nearest to so many, or to some minutes [s]. */
const WINDOWS = [10, 60, 300, 900, 3600, 4 * 3600, 12 * 3600, 86_400, 3 * 86_400, 10 * 86_400, 60 * 86_400];
const [FEWEST, FIRST, LONGEST] = [100, 1000, 1_000_000];
const SHORTEST_FIRST = 300;
/** Of a button. */
const ZOOM = 1.5;
/** The properties that hold the colours of other runs. */
export const OVERLAY_COLOURS = ["--curve-1", "--curve-2", "--curve-3", "--curve-4", "--curve-5", "--curve-6", "--curve-7"];

/** A run as trends see it. */
export interface TrendRun {
  name: string;
  history: Past;
  touches: Touch[];
  titles: Record<string, string>;
  happened: Happening[];
}

/** What is to be seen: a run, where the rig stands in it, and others over it. */
export interface Source {
  run: TrendRun;
  sample: number;
  others: TrendRun[];
}

export class Trends {
  readonly view: View;
  private readonly place: HTMLElement;
  private readonly data: PlantData;
  private readonly signals: Map<string, ShownSignal>;
  private readonly source: () => Source;
  private readonly say: (words: string) => void;
  private readonly windows: number[];
  private readonly bar = element("div", "tools");
  private readonly select = element("select", "");
  private readonly near = element("p", "near", "");
  private readonly legend = element("p", "runs-legend", "");
  private readonly between: Between;
  private clear!: HTMLButtonElement;
  private saves: HTMLButtonElement[] = [];
  private readonly identify: Identify;
  private readonly more: MoreTrends;
  private readonly figures = element("div", "figures");
  private readonly thinned = new WeakMap<Past, Thinned>();
  private charts: { name: string; chart: TrendChart }[] = [];
  /** The runs that charts and legend were made for, by their names. */
  private built = "";
  private readonly marks: Marks;
  private run: TrendRun | undefined;
  private isWaiting = false;
  private isSeen = false;

  constructor(place: HTMLElement, data: PlantData, signals: Map<string, ShownSignal>, source: () => Source, say: (words: string) => void, titled: (controller: string) => string) {
    this.place = place;
    this.data = data;
    this.signals = signals;
    this.marks = new Marks(new TouchWords(data, titled));
    this.source = source;
    this.say = say;
    const all = WINDOWS.map((seconds) => Math.round(seconds / data.period));
    this.windows = all.filter((samples) => samples >= FEWEST && samples <= LONGEST);
    const first = Math.max(FIRST, SHORTEST_FIRST / data.period);
    const away = (samples: number): number => Math.abs(Math.log(samples / first));
    this.view = new View(this.windows.reduce((best, each) => (away(each) < away(best) ? each : best)));
    this.between = new Between(data, signals);
    const marked = () => ({ past: source().run.history, stretch: this.stretch(), file: `${this.file()}.csv` });
    this.identify = new Identify(data, marked, () => this.save("csv"));
    this.more = new MoreTrends(data, () => this.build());
    this.fill();
    this.place.append(this.bar, this.near, this.legend, this.figures, this.more.place, this.between.place, this.identify.place);
    this.build();
    onLook(() => this.build());
    new ResizeObserver(() => this.resize()).observe(place);
    new IntersectionObserver(([entry]) => {
      this.isSeen = entry!.isIntersecting;
      this.soon();
    }).observe(place);
  }

  /** Show what was, up to now, if anybody sees it; a picture that will stay is drawn anyway. */
  show(stays = false): void {
    const { history } = this.source().run;
    this.view.reach(history.first, history.count);
    if (this.isSeen || stays) this.draw();
  }

  private draw(): void {
    const { run, sample, others } = this.source();
    if (namesOf([run, ...others]) !== this.built) return this.build();
    const { view } = this;
    if (run !== this.run) this.between.forget();
    this.run = run;
    view.reach(run.history.first, run.history.count);
    this.marks.read(run.touches, run.happened);
    const first = Math.floor(view.first);
    const grid = gridOf(first, Math.max(first, Math.min(Math.ceil(view.last) + 1, this.end(others, run))), MOST);
    const standing = sample < run.history.count ? sample : undefined;
    const shown: Shown = { view, period: this.data.period, samples: grid.samples, marks: this.marks, standing };
    for (const { name, chart } of this.charts) {
      const curve = (past: Past, of: string): number[] => this.thin(past).curve(of, grid);
      const curves: Curve[] = this.looks(name).map((look) => ({ ...look, values: curve(look.run.history, look.of) }));
      chart.show(shown, curves);
    }
    this.between.show([run, ...others], view.cursors);
    this.identify.show();
    this.tellWindow();
    this.tellCursors();
    this.tellNear();
  }

  /** Show it anew in the next frame. */
  soon(): void {
    if (this.isWaiting) return;
    this.isWaiting = true;
    requestAnimationFrame(() => {
      this.isWaiting = false;
      this.show();
    });
  }

  /** Return the samples that a hand has marked, else all that there are, the last one included. */
  stretch(): [number, number] {
    const { history } = this.source().run;
    return this.view.stretch ?? [history.first, history.count - 1];
  }

  private end(others: TrendRun[], run: TrendRun): number {
    return Math.max(run.history.count, ...others.map(({ history }) => history.count));
  }

  private thin(past: Past): Thinned {
    const found = this.thinned.get(past) ?? new Thinned(past);
    this.thinned.set(past, found);
    return found;
  }

  /** Return the curves of a trend: who has them, what they are of, and how they look. */
  private looks(name: string): (Omit<Curve, "values"> & { run: TrendRun; of: string })[] {
    const { run, others } = this.source();
    const setpoint = this.data.controlled.includes(name) ? [{ run, of: `${name}.setpoint`, property: "--ink", kind: "setpoint" as const }] : [];
    return [
      { run, of: name, property: "--curve-0", kind: "own" },
      ...setpoint,
      ...others.map((each, place) => ({ run: each, of: name, property: OVERLAY_COLOURS[place % OVERLAY_COLOURS.length]!, kind: "other" as const })),
    ];
  }

  private build(): void {
    for (const { chart } of this.charts) chart.chart.destroy();
    this.figures.replaceChildren();
    const { run, others } = this.source();
    this.built = namesOf([run, ...others]);
    this.charts = [...this.data.controlled, ...this.data.inputs, ...this.more.shown].map((name) => {
      const held = !this.data.measurements.includes(name);
      const chart: TrendChart = new TrendChart(this.figures, this.signals.get(name)!, this.looks(name), held, () => void this.savePicture(name, chart));
      const scale = (): number => 1 / this.data.period;
      listen(chart.chart, chart.canvas, { view: this.view, scale, snapped: (sample, within) => this.snapped(sample, within), changed: () => this.soon() });
      chart.chart.over.addEventListener("mousemove", () => this.tellNear());
      return { name, chart };
    });
    // Only beside the others each has its width.
    this.resize();
    this.tellRuns();
    this.draw();
  }

  private resize(): void {
    for (const { chart } of this.charts) chart.resize();
  }

  /** Tell which colour is which run, where there are several. */
  private tellRuns(): void {
    const { run, others } = this.source();
    const words = [run, ...others].map(({ name }, place) => {
      const found = element("span", "", name);
      found.style.setProperty("--own", `var(${place ? OVERLAY_COLOURS[(place - 1) % OVERLAY_COLOURS.length] : "--curve-0"})`);
      return found;
    });
    this.legend.replaceChildren(...(others.length ? words : []));
  }

  private fill(): void {
    const label = element("label", "", "Trends over ");
    const free = element("option", "", "");
    free.hidden = true;
    this.select.append(free, ...this.windows.map((samples) => {
      const seconds = samples * this.data.period;
      const [unit, length] = timeUnit(seconds);
      return Object.assign(element("option", "", `${numberText(seconds / length, 3)} ${unit}`), { value: String(samples) });
    }));
    this.select.addEventListener("change", () => {
      this.view.follow(Number(this.select.value));
      this.soon();
    });
    label.append(this.select);
    const { view } = this;
    const middle = (): number => (view.isFollowing ? view.last : (view.first + view.last) / 2);
    const tool = (words: string, title: string, action: () => void): HTMLButtonElement => {
      const found = element("button", "", words);
      if (title) found.title = title;
      found.addEventListener("click", () => (action(), this.soon()));
      return found;
    };
    const sign = (words: string, name: string, action: () => void): HTMLButtonElement => {
      const found = tool(words, name, action);
      found.setAttribute("aria-label", name);
      return found;
    };
    this.clear = tool("Clear cursors", "", () => view.unmark());
    this.saves = [
      tool("Save CSV", "", () => this.save("csv")),
      tool("Save MAT", "", () => this.save("mat")),
    ];
    this.bar.append(
      label,
      sign("−", "See more time", () => view.zoom(ZOOM, middle())),
      sign("+", "See less time", () => view.zoom(1 / ZOOM, middle())),
      tool("Now", "Follow the run", () => view.follow()),
      tool("All", "See the whole run", () => view.all()),
      this.clear,
      ...this.saves,
    );
  }

  private tellWindow(): void {
    const { select, view } = this;
    const known = this.windows.indexOf(Math.round(view.length));
    const free = select.options[0]!;
    if (known < 0) free.textContent = timeText(view.length * this.data.period, "", 3);
    if (select.selectedIndex !== known + 1 && document.activeElement !== select) select.selectedIndex = known + 1;
  }

  /** Tell what the cursors are good for. */
  private tellCursors(): void {
    const { clear, saves, view } = this;
    clear.disabled = view.cursors.length === 0;
    const what = view.stretch ? " from A to B" : "";
    ["Save CSV", "Save MAT"].forEach((words, place) => {
      if (saves[place]!.textContent !== words + what) saves[place]!.textContent = words + what;
    });
  }

  /** Tell the time at the mouse, and what was done there. */
  private tellNear(): void {
    const over = this.charts.find(({ chart }) => (chart.chart.cursor.left ?? -1) >= 0 && chart.chart.over.matches(":hover"))?.chart.chart;
    let text = this.view.stretch
      ? "Drag to zoom in; the wheel zooms after a click, or with Ctrl."
      : "Click a trend to set cursor A, and again to set B: scores between them appear below. Drag to zoom in; the wheel zooms after a click, or with Ctrl.";
    if (over) {
      const time = over.posToVal(over.cursor.left!, "x");
      const within = (5 * this.view.length * this.data.period) / Math.max(1, over.over.clientWidth);
      const done = this.marks.near(time / this.data.period, within / this.data.period);
      text = [timeText(time, "", 5), ...done.map(({ words }) => words)].join(": ");
    }
    if (this.near.textContent !== text) this.near.textContent = text;
  }

  private snapped(sample: number, within: number): number {
    return this.marks.near(sample, within)[0]?.sample ?? sample;
  }

  private file(): string {
    const [first, last] = this.stretch();
    const { period, name } = this.data;
    const part = this.view.stretch ? `-${[first, last].map((sample) => numberText(sample * period, 6)).join("-")}s` : "";
    return `${name}-${fileStem(this.source().run.name)}${part}`;
  }

  private save(kind: "csv" | "mat"): void {
    const { data, signals } = this;
    const { history } = this.source().run;
    const [first, last] = this.stretch();
    const file = `${this.file()}.${kind}`;
    if (kind === "csv") saveFile(file, csvOf(data, signals, history, [first, last]), "text/csv");
    else saveFile(file, [matOf(data, signals, history, [first, last])], "application/octet-stream");
    const from = `from ${timeText(first * data.period, "", 6)} to ${timeText(last * data.period, "", 6)}`;
    this.say(`Saved ${file}: ${last - first + 1} samples, ${from}.`);
  }

  private async savePicture(name: string, { chart, title }: TrendChart): Promise<void> {
    const { run } = this.source();
    const file = `${this.data.name}-${fileStem(run.name)}-${fileStem(name)}.png`;
    saveFile(file, [await pictureOf(chart, `${this.data.name}, ${run.name}: ${title}`)], "image/png");
    this.say(`Saved ${file}.`);
  }
}

const namesOf = (runs: TrendRun[]): string => JSON.stringify(runs.map(({ name }) => name));
