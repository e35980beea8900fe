/** What the reader handles: which controller, its sliders, and what becomes of it. */

import { copyOnClick } from "../copy.ts";
import type { LiveData } from "./messages.ts";
import { Sliders } from "./sliders.ts";
import { cellText, MARGINS, marginTexts, numbersOf, type Outcome, warnings } from "./told.ts";
import type { TriedSettings } from "./tried_settings.ts";

/** How long all has to rest before it is said aloud [ms]. */
const REST = 900;

/** What the reader asks for. */
export interface Wishes {
  opened(): void;
  chosen(controller: number): void;
  moved(): void;
  back(): void;
  keep(): void;
}

/** How a controller is as the study has it: its run, and its cells of the ranking. */
export interface Before {
  outcome: Outcome | undefined;
  cells: string[];
  isRecommended: boolean;
}

/** Return what the study's settings of a controller are called. */
function beforeText(isRecommended: boolean): string {
  return isRecommended ? "recommended" : "original";
}

export class Panel {
  readonly place = document.createElement("details");
  private readonly live: LiveData;
  /** Of each controller, in its order. */
  private readonly sliders: Sliders[];
  private readonly back: HTMLButtonElement;
  private readonly keep: HTMLButtonElement;
  private readonly figures = document.createElement("table");
  private readonly margins = document.createElement("table");
  private readonly watched = document.createElement("div");
  private readonly said = document.createElement("p");
  private resting = 0;

  /** `isRecommended`: of each controller whether the report recommends it. */
  constructor(live: LiveData, tried: TriedSettings[], isRecommended: boolean[], wishes: Wishes) {
    const backText = (controller: number) => `Back to the ${beforeText(isRecommended[controller]!)}`;
    this.live = live;
    this.place.id = "live";
    this.place.className = "live";
    const summary = document.createElement("summary");
    const hint = document.createElement("span");
    hint.className = "unit";
    hint.textContent = " Drag a gain: curves, figures and margins follow.";
    summary.append("Try other settings", hint);
    this.sliders = tried.map((each) => new Sliders(each, () => wishes.moved()));
    this.back = button(backText(0), () => wishes.back());
    this.keep = button("Keep as a row", () => wishes.keep());
    const copy = button("Copy these settings");
    let chosen = 0;
    copyOnClick(copy, () => tried[chosen]!.text);
    const choose = (controller: number) => {
      chosen = controller;
      this.sliders.forEach(({ place }, each) => (place.hidden = each !== controller));
      this.back.textContent = backText(controller);
      wishes.chosen(controller);
    };
    const actions = document.createElement("p");
    actions.className = "actions";
    actions.append(this.back, copy, this.keep);
    this.watched.className = "watched";
    this.said.className = "unseen";
    this.said.setAttribute("role", "status");
    this.sliders.forEach(({ place }, each) => (place.hidden = each !== 0));
    this.place.append(summary, choice(live, isRecommended, choose), ...this.sliders.map(({ place }) => place));
    this.place.append(actions, this.figures, this.watched, this.margins, this.said);
    this.place.addEventListener("toggle", () => this.place.open && wishes.opened());
  }

  /** Let the sliders of a controller stand at what is tried. */
  refresh(controller: number): void {
    this.sliders[controller]!.refresh();
  }

  /** Say what can be done now. */
  offer(back: boolean, keep: boolean): void {
    this.back.disabled = !back;
    this.keep.disabled = !keep;
  }

  /** Show what has to be watched. */
  watch(found: string[]): void {
    this.watched.replaceChildren(...found.map(watchLine));
  }

  /** Tell what a run is worth beside what it was before, and a moment later aloud. */
  tell(outcome: Outcome | undefined, before: Before, isPartial: boolean): void {
    const { columns } = this.live;
    const words = beforeText(before.isRecommended);
    const numbers = outcome && numbersOf(outcome, columns);
    const rows = columns.map((column, place): [string, string, string] => [
      column.title,
      numbers ? cellText(column, numbers[place]!) : "…",
      before.cells[place]!,
    ]);
    fill(this.figures, "", ["", isPartial ? "computing …" : "now", words], rows);
    const found = outcome ? warnings(outcome, before.outcome, this.live, words) : [];
    this.watch(found);
    const earlier = before.outcome?.analysed?.margins.map(marginTexts) ?? [];
    const margins = outcome?.analysed?.margins.map((each, place): [string, ...Node[]] => [
      each.name,
      ...marginTexts(each).map((text, column) => beside(text, earlier[place]?.[column])),
    ]);
    fill(this.margins, `Margins, ${words} in brackets`, ["", ...MARGINS], margins ?? []);
    if (isPartial) return;
    const moved = rows.filter(([, now, then], place) => columns[place]!.kind !== "multiples" && now !== then);
    this.announce([...found, ...moved.map(([title, now, then]) => `${title} ${now}, ${words} ${then}.`)]);
  }

  /** Say it aloud once all has come to rest. */
  private announce(sentences: string[]): void {
    clearTimeout(this.resting);
    this.resting = setTimeout(() => (this.said.textContent = sentences.join(" ")), REST);
  }
}

function choice(live: LiveData, isRecommended: boolean[], choose: (controller: number) => void): HTMLElement {
  const group = document.createElement("fieldset");
  group.className = "choice";
  const legend = document.createElement("legend");
  legend.className = "unseen";
  legend.textContent = "Controller";
  group.append(legend);
  live.controllers.forEach(({ name }, place) => {
    const label = document.createElement(live.controllers.length > 1 ? "label" : "p");
    const radio = document.createElement("input");
    radio.type = "radio";
    radio.name = "live";
    radio.checked = place === 0;
    radio.addEventListener("change", () => choose(place));
    const role = document.createElement("span");
    role.className = "unit";
    role.textContent = isRecommended[place] ? " recommended" : "";
    label.append(...(live.controllers.length > 1 ? [radio] : []), name, role);
    group.append(label);
  });
  return group;
}

function button(words: string, act?: () => void): HTMLButtonElement {
  const made = document.createElement("button");
  made.type = "button";
  made.textContent = words;
  if (act) made.addEventListener("click", act);
  return made;
}

function watchLine(words: string): HTMLElement {
  const line = document.createElement("p");
  line.className = "watch";
  line.textContent = words;
  return line;
}

/** Return a text, and in brackets what it was. */
function beside(text: string, before: string | undefined): Node {
  const [cell, was] = [document.createElement("span"), document.createElement("span")];
  was.className = "unit";
  was.textContent = `(${before ?? "–"})`;
  cell.append(text, " ", was);
  return cell;
}

/** Fill a table anew: the first cell of a row names it. */
function fill(table: HTMLTableElement, caption: string, head: string[], rows: [string, ...(string | Node)[]][]): void {
  table.replaceChildren();
  if (!rows.length) return;
  if (caption) table.createCaption().textContent = caption;
  const top = table.createTHead().insertRow();
  for (const words of head) {
    const cell = document.createElement(words ? "th" : "td");
    if (words) cell.setAttribute("scope", "col");
    cell.textContent = words;
    top.append(cell);
  }
  const body = table.createTBody();
  for (const [name, ...cells] of rows) {
    const row = body.insertRow();
    const title = document.createElement("th");
    title.scope = "row";
    title.textContent = name;
    row.append(title);
    for (const cell of cells) row.insertCell().append(cell);
  }
}
