/** A report that answers: the first controllers run anew in the page with the reader's settings. */

import { decoded, type PageData } from "../data.ts";
import type { Curve } from "../event_chart.ts";
import type { TakeCurves } from "../events.ts";
import type { AddPoint } from "../map.ts";
import type { Ranking } from "../ranking.ts";
import type { TakeSensitivity } from "../sensitivity.ts";
import type { Shown } from "../shown.ts";
import { type AnalysedMessage, FORM, type LiveColumn, type LiveData, type RanMessage } from "./messages.ts";
import { Panel } from "./panel.ts";
import { type Listener, Runner, type Trial } from "./runner.ts";
import { cellText, numbersOf, type Outcome } from "./told.ts";
import { TriedSettings } from "./tried_settings.ts";

/** What the rest of the page does with a controller that is tried. */
export interface Pictures {
  shown: Shown;
  ranking: Ranking;
  take: TakeCurves;
  addPoint: AddPoint;
  takeSensitivity: TakeSensitivity;
}

/** Put what the reader can try before the pictures of the events, if the report carries it. */
export function addLive(overlay: HTMLElement, data: PageData, pictures: Pictures): void {
  if (!data.live) return;
  const why = hindrance(data.live);
  if (why) return overlay.before(sentence(why));
  const { place } = new Live(data, data.live, pictures).panel;
  overlay.before(place);
  const link = document.createElement("a");
  link.href = "#live";
  link.textContent = "Try other settings";
  link.addEventListener("click", () => (place.open = true));
  document.querySelector("nav a[href='#events']")?.after(link);
}

/** How the sentences end that stand in the place of sliders. */
const SO = "so other settings cannot be tried.";
const UNABLE = `The browser lets this page start no worker, ${SO}`;

function sentence(why: string): HTMLElement {
  const words = document.createElement("p");
  words.id = "live";
  words.className = "note";
  words.textContent = why;
  return words;
}

/** Return in a sentence why nothing can be computed here; empty where it can. */
function hindrance({ form }: LiveData): string {
  if (form !== FORM) return `This report was written by another version of Clepsydra than its script, ${SO}`;
  if (typeof WebAssembly === "undefined") return `This browser has no WebAssembly, ${SO}`;
  try {
    // The least module: its magic number and version.
    new WebAssembly.Module(new Uint8Array([0, 97, 115, 109, 1, 0, 0, 0]));
  } catch {
    return `WebAssembly is forbidden here, by the browser or by the page around, ${SO}`;
  }
  return "";
}

class Live implements Listener {
  readonly panel: Panel;
  private readonly data: PageData;
  private readonly live: LiveData;
  private readonly pictures: Pictures;
  private readonly tried: TriedSettings[];
  private readonly isRecommended: boolean[];
  private runner: Runner | undefined;
  private chosen = 0;
  /** What was asked for last, and what a run is worth that was asked for then or just before. */
  private asked: Trial | undefined;
  private outcome: Outcome | undefined;
  /** Of each controller with the study's settings. */
  private readonly outcomes: (Outcome | undefined)[] = [];
  /** To be drawn in the next frame. */
  private next: RanMessage | undefined;
  private isAwaited = false;
  /** Whether what is seen of it is not all. */
  private isPartial = true;
  /** Place of what is tried among the controllers of the page, once it differs. */
  private row: number | undefined;
  private kept = 0;

  constructor(data: PageData, live: LiveData, pictures: Pictures) {
    [this.data, this.live, this.pictures] = [data, live, pictures];
    this.tried = live.controllers.map((each) => new TriedSettings(each));
    this.isRecommended = live.controllers.map(({ controller }) => pictures.ranking.isRecommended(controller));
    this.panel = new Panel(live, this.tried, this.isRecommended, {
      opened: () => this.open(),
      chosen: (controller) => this.choose(controller),
      moved: () => this.ask(),
      back: () => this.goBack(),
      keep: () => this.keep(),
    });
    this.offer();
  }

  ran(trial: Trial, ran: RanMessage): void {
    if (trial.isAsBefore && ran.whole) this.outcomes[trial.controller] = { trial, ran, analysed: null };
    if (!this.isWanted(trial)) return;
    this.next = ran;
    this.isPartial = !ran.whole;
    // Until it is analysed anew, max|S| is that of a moment ago.
    if (ran.whole) this.outcome = { trial, ran, analysed: this.outcome?.analysed ?? null };
    this.await();
  }

  analysed(trial: Trial, analysed: AnalysedMessage): void {
    const before = this.outcomes[trial.controller];
    if (before?.ran.run === analysed.run) before.analysed = analysed;
    if (!this.outcome || !this.isWanted(trial)) return;
    this.outcome.analysed = analysed;
    this.await();
  }

  refused(words: string | undefined, isFinal: boolean): void {
    if (!isFinal) return this.panel.watch([words ?? UNABLE]);
    this.hide();
    this.panel.place.replaceWith(sentence(words ?? UNABLE));
  }

  private get settings(): TriedSettings {
    return this.tried[this.chosen]!;
  }

  /** Compute what it is before anything is moved: it is what changes are told beside. */
  private open(): void {
    if (this.runner) return;
    const program = document.getElementById("worker")?.textContent ?? "";
    const address = URL.createObjectURL(new Blob([program], { type: "text/javascript" }));
    const samples = this.data.events.map((each) => decoded(each.samples, 1) as number[]);
    const frequencies = this.data.sensitivity?.frequencies ?? [];
    try {
      this.runner = new Runner(new Worker(address), { kind: "load", data: this.live, samples, frequencies }, this);
    } catch {
      return this.refused(undefined, true);
    }
    this.ask();
    this.draw();
  }

  private ask(): void {
    const { values, isAsBefore } = this.settings;
    this.asked = { controller: this.chosen, values, isAsBefore };
    this.runner?.ask(this.asked);
    this.offer();
  }

  /** Whether a trial is of what the sliders are at, or were a moment ago. */
  private isWanted({ controller, isAsBefore }: Trial): boolean {
    return controller === this.chosen && isAsBefore === this.settings.isAsBefore;
  }

  private await(): void {
    if (this.isAwaited) return;
    this.isAwaited = true;
    requestAnimationFrame(() => {
      this.isAwaited = false;
      this.draw();
    });
  }

  private draw(): void {
    if (this.next && !this.settings.isAsBefore) {
      this.row ??= this.newRow();
      this.pictures.take(this.row, this.next.curves.map((event) => event.map(drawable)));
      this.pictures.shown.set(this.row, true);
      this.pictures.shown.paint(this.panel.place, this.row);
    }
    this.next = undefined;
    const { analysed } = this.outcome ?? {};
    if (analysed && this.row !== undefined)
      this.pictures.takeSensitivity(this.row, analysed.sensitivity.map(finite));
    const { controller } = this.live.controllers[this.chosen]!;
    const cells = this.pictures.ranking.cells(controller);
    const isRecommended = this.isRecommended[this.chosen]!;
    this.panel.tell(this.outcome, { outcome: this.outcomes[this.chosen], cells, isRecommended }, this.isPartial);
    this.offer();
  }

  private newRow(): number {
    const title = `${this.live.controllers[this.chosen]!.name}, changed`;
    return this.data.controllers.push({ title, standing: "not ranked", peak: null, error: null }) - 1;
  }

  private hide(): void {
    this.next = undefined;
    if (this.row !== undefined) this.pictures.shown.set(this.row, false);
  }

  private choose(controller: number): void {
    this.hide();
    this.chosen = controller;
    this.outcome = undefined;
    this.isPartial = true;
    if (this.row !== undefined) this.data.controllers[this.row]!.title = `${this.live.controllers[controller]!.name}, changed`;
    this.ask();
    this.draw();
  }

  private goBack(): void {
    this.settings.reset();
    this.panel.refresh(this.chosen);
    this.hide();
    const before = this.outcomes[this.chosen];
    this.outcome = before && { ...before };
    this.isPartial = !before;
    if (before) this.draw();
    else this.ask();
  }

  private keep(): void {
    const { row, outcome } = this;
    if (row === undefined || !outcome) return;
    this.kept += 1;
    const { columns } = this.live;
    const numbers = numbersOf(outcome, columns);
    const kept = this.data.controllers[row]!;
    kept.title += ` ${this.kept}`;
    kept.peak = finite(outcome.analysed?.peak ?? NaN);
    kept.error = finite(numbers[relativeError(columns)] ?? NaN);
    const cells = numbers.map((number, place) => ({ text: cellText(columns[place]!, number), number }));
    const mark = `+${this.kept}`;
    this.pictures.ranking.append(row, mark, kept, cells);
    this.pictures.addPoint(row, mark);
    this.row = undefined;
    this.pictures.shown.tell();
    this.offer();
  }

  /** Offer to go back from what differs, and to keep what is known whole. */
  private offer(): void {
    const { slopes, plant } = this.live.controllers[this.chosen]!;
    const { trial, ran, analysed } = this.outcome ?? {};
    const isKnown = trial === this.asked && (!slopes || !plant || analysed?.run === ran?.run);
    const isChanged = !this.settings.isAsBefore;
    this.panel.offer(isChanged, isChanged && isKnown && this.row !== undefined);
  }
}

function drawable(curve: Float64Array | null): Curve | undefined {
  return curve ? Array.from(curve, finite) : undefined;
}

function finite(value: number): number | null {
  return Number.isFinite(value) ? value : null;
}

/** Return the place of the column whose number is the mean over all groups of scores. */
function relativeError(columns: LiveColumn[]): number {
  const most = Math.max(...columns.map(({ groups }) => groups.length));
  return columns.findIndex(({ kind, groups }) => kind === "multiples" && groups.length === most);
}
