/** The list of runs as it is shown: each is opened, laid over the trends, named, pinned, saved or deleted. */

import type { SessionFile } from "./data.ts";
import { element } from "./faceplates.ts";
import { fileStem, saveFile } from "./files.ts";
import { KeptRuns, type Store } from "./kept_runs.ts";
import type { Rig } from "./rig.ts";
import type { Run } from "./run.ts";
import { type Entry, RunList } from "./run_list.ts";
import { readSession, Refused } from "./session_file.ts";
import { OVERLAY_COLOURS } from "./trends.ts";

/** Samples that are computed between two looks at the page. */
const CHUNK = 20_000;
/** Of a file that is read: some hundred thousand touches [bytes]. */
const LARGEST = 20_000_000;

const GONE = "Runs are gone when this page is closed: save those that you need.";
const FULL = "The browser has no room for more runs: save those that you need as files, or delete others. Nothing is lost while the page is open.";

export interface RunsHandler {
  /** Time stands still while a run is computed. */
  pause(): void;
  /** The rig stands in another run, or elsewhere in it. */
  moved(): void;
  /** Other runs lie over the trends. */
  overlaid(): void;
  say(words: string): void;
}

export class Runs {
  private readonly rig: Rig;
  private readonly handler: RunsHandler;
  private readonly runs: RunList;
  private readonly list = element("ul", "");
  private readonly note = element("p", "note", "");
  /** Why a file was refused. */
  private readonly refused = element("p", "refused");
  /** How far each run goes. */
  private words = new Map<Entry, HTMLElement>();
  private shown = "";
  /** The run that was deleted last. */
  private removed: Entry | undefined;
  private readonly undo = button("", "", () => this.bringBack());
  private isBusy = false;

  constructor(place: HTMLElement, rig: Rig, store: Store | undefined, handler: RunsHandler) {
    this.rig = rig;
    this.handler = handler;
    this.runs = new RunList(rig, new KeptRuns(rig.data, store));
    if (!store) this.note.textContent = GONE;
    const file = Object.assign(element("input", "unseen"), { type: "file", accept: ".json,application/json" });
    file.setAttribute("aria-label", "Session to open");
    file.addEventListener("change", () => {
      const [chosen] = file.files ?? [];
      if (chosen) void this.take(chosen);
      file.value = "";
    });
    const tools = element("div", "tools");
    tools.append(element("h2", "", "Runs"), button("Open a session…", "", () => file.click()), file, this.undo);
    this.refused.setAttribute("role", "alert");
    this.refused.hidden = true;
    place.append(tools, this.refused, this.note, this.list);
    addEventListener("drop", (event) => {
      const session = [...(event.dataTransfer?.files ?? [])].find(({ name }) => /\.json$/i.test(name));
      if (!session) return;
      event.preventDefault();
      void this.take(session);
    });
    addEventListener("dragover", (event) => event.preventDefault());
    this.show();
  }

  /** Runs that lie over the trends, in the order of their colours. */
  get overlaid(): Run[] {
    return this.runs.overlaid;
  }

  /** Show the list where it has changed; while a run goes on, nothing of it moves under a hand. */
  show(): void {
    this.runs.learn();
    const { all } = this.runs;
    const shown = JSON.stringify(all.map((each) => [each.id, each.name, each.isPinned, each.isOver, each.run === this.rig.run]));
    const isTyping = this.list.contains(document.activeElement) && document.activeElement instanceof HTMLInputElement;
    if (shown !== this.shown && !isTyping) {
      this.shown = shown;
      this.undo.hidden = !this.removed;
      this.undo.textContent = this.removed ? `Bring back ${this.removed.name}` : "";
      const focused = (document.activeElement as HTMLElement | null)?.dataset.key;
      this.words = new Map(all.map((each) => [each, element("span", "words", "")]));
      this.list.replaceChildren(...all.map((each) => this.row(each)));
      if (focused) this.list.querySelector<HTMLElement>(`[data-key="${CSS.escape(focused)}"]`)?.focus();
    }
    for (const [entry, place] of this.words) {
      const words = entry.words(this.rig.data);
      if (place.textContent !== words) place.textContent = words;
    }
  }

  /** Keep what was done so far, also when the page is closed. */
  keep(): void {
    if (this.runs.keep() || this.note.textContent === FULL) return;
    this.note.textContent = FULL;
    this.handler.say(FULL);
  }

  /** Save the session of a run, or of the one that is shown. */
  save(session = this.rig.session(), name = this.rig.run.name): void {
    const file = `${this.rig.data.name}-${fileStem(name)}-session.json`;
    saveFile(file, [`${JSON.stringify(session, null, 1)}\n`], "application/json");
    this.handler.say(`Saved ${session.samples} samples; clepsydra replay ${file} runs them again.`);
  }

  /** Take a session from a file. */
  private async take(file: File): Promise<void> {
    const { name } = file;
    if (file.size > LARGEST) return this.refuse(`${name} is not a session: it is larger than any.`);
    try {
      const session = readSession(await file.text(), this.rig.data);
      await this.compute(session, this.runs.freeName(name.replace(/\.json$/i, "")));
      this.refused.hidden = true;
      this.handler.say(`Opened ${name}: ${session.samples} samples.`);
    } catch (error) {
      if (!(error instanceof Refused)) throw error;
      this.refuse(`${name}: ${error.message}.`);
    }
  }

  /** Tell why a file is refused, where the reader sees it. */
  private refuse(words: string): void {
    this.refused.textContent = words;
    this.refused.hidden = false;
    this.refused.scrollIntoView({ block: "center" });
  }

  private row(entry: Entry): HTMLLIElement {
    const { rig } = this;
    const { run, name, id } = entry;
    const isShown = run === rig.run;
    const row = element("li", isShown ? "current" : "");
    const field = Object.assign(element("input", ""), { type: "text", value: name, maxLength: 60 });
    field.setAttribute("aria-label", "Name of the run");
    field.dataset.key = `${id} name`;
    field.addEventListener("change", () => (this.rename(entry, field.value), field.blur()));
    field.addEventListener("keydown", ({ key }) => key === "Enter" && field.blur());
    field.addEventListener("blur", () => this.show());
    const act = (words: string, action: () => void, isPressed?: boolean): HTMLButtonElement => {
      const found = button(words, `${words} ${name}`, action);
      found.dataset.key = `${id} ${words}`;
      if (isPressed !== undefined) found.setAttribute("aria-pressed", String(isPressed));
      return found;
    };
    const over = act("Overlay", () => void this.overlay(entry), entry.isOver);
    const place = run ? this.overlaid.indexOf(run) : -1;
    if (place >= 0) over.style.setProperty("--own", `var(${OVERLAY_COLOURS[place % OVERLAY_COLOURS.length]})`);
    const pin = act("Pin", () => this.pin(entry), entry.isPinned);
    const save = act("Save", () => this.save(entry.session(rig), name));
    row.append(field, this.words.get(entry)!);
    if (isShown) row.append(element("b", "", "shown"), pin, save);
    else row.append(act("Open", () => void this.open(entry)), over, pin, save, act("Delete", () => this.remove(entry)));
    return row;
  }

  private rename(entry: Entry, name: string): void {
    const wanted = name.trim();
    if (wanted && wanted !== entry.name) entry.name = this.runs.freeName(wanted);
    this.changed();
  }

  private pin(entry: Entry): void {
    entry.isPinned = !entry.isPinned;
    this.changed();
  }

  private changed(): void {
    this.keep();
    this.show();
  }

  private remove(entry: Entry): void {
    this.runs.remove(entry);
    this.removed = entry;
    this.show();
    this.undo.focus();
    this.handler.overlaid();
    this.handler.say(`${entry.name} is deleted.`);
  }

  private bringBack(): void {
    if (this.removed) this.runs.bringBack(this.removed);
    this.removed = undefined;
    this.changed();
    this.handler.overlaid();
  }

  private async open(entry: Entry): Promise<void> {
    if (this.isBusy) return;
    if (entry.run) {
      this.handler.pause();
      this.rig.open(entry.run);
      await this.finish(entry.run);
    } else await this.compute(entry.session(this.rig), entry.name, entry);
    this.handler.say(`${entry.name} is at its end.`);
  }

  private async overlay(entry: Entry): Promise<void> {
    if (this.isBusy) return;
    entry.isOver = !entry.isOver;
    if (entry.isOver && !entry.run) {
      const { run, sample } = this.rig;
      await this.compute(entry.session(this.rig), entry.name, entry);
      this.rig.open(run);
      if (sample < run.history.count) this.rig.goTo(sample);
      this.moved();
    }
    this.show();
    this.handler.overlaid();
  }

  /** Compute a run anew from its session, and stand at its end. */
  private async compute(session: SessionFile, name: string, entry?: Entry): Promise<void> {
    this.handler.pause();
    const run = this.rig.load(session, name);
    entry?.become(run);
    await this.finish(run);
  }

  /** Compute what is still to come of the run that the rig has, unless a hand takes another one. */
  private async finish(run: Run): Promise<void> {
    const { rig, handler } = this;
    this.isBusy = true;
    while (rig.run === run && rig.due > 0) {
      // Whoever goes back in the meantime is brought to where it goes on.
      if (rig.sample < run.history.count) rig.goTo(run.history.count);
      rig.catchUp(CHUNK);
      if (rig.due <= 0) break;
      handler.say(`Computes ${run.name}: ${Math.round((100 * run.history.count) / run.samples)} % done.`);
      await new Promise((done) => setTimeout(done));
    }
    this.isBusy = false;
    this.moved();
  }

  private moved(): void {
    this.handler.moved();
    this.show();
  }
}

function button(words: string, label: string, action: () => void): HTMLButtonElement {
  const found = element("button", "", words);
  if (label) found.setAttribute("aria-label", label);
  found.addEventListener("click", action);
  return found;
}
