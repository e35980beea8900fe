/** Every run that there is, of this visit and of earlier ones, and what of them is kept. */

import { timeText } from "../words.ts";
import type { LabData, SessionFile } from "./data.ts";
import { inControl } from "./in_control.ts";
import type { KeptRun, KeptRuns } from "./kept_runs.ts";
import type { Rig } from "./rig.ts";
import type { Run } from "./run.ts";

/** A run of the list: computed, or so far only its session. */
export class Entry {
  readonly id: string;
  /** Whether it lies over the trends. */
  isOver = false;
  private held: Run | KeptRun;

  constructor(id: string, held: Run | KeptRun) {
    this.id = id;
    this.held = held;
  }

  /** The run, once it is computed. */
  get run(): Run | undefined {
    return "session" in this.held ? undefined : this.held;
  }

  get name(): string {
    return this.held.name;
  }

  set name(name: string) {
    this.held.name = name;
  }

  get isPinned(): boolean {
    return this.held.isPinned;
  }

  set isPinned(isPinned: boolean) {
    this.held.isPinned = isPinned;
  }

  session(rig: Rig): SessionFile {
    return "session" in this.held ? this.held.session : rig.session(this.held);
  }

  /** Become the run that is computed from its session. */
  become(run: Run): void {
    run.isPinned = this.isPinned;
    this.held = run;
  }

  /** Tell how far it goes, and who had the rig. */
  words({ period, controllers }: LabData): string {
    const held = "session" in this.held ? this.held.session : this.held;
    const { samples, touches } = held;
    const titles = inControl(held, controllers, 0, samples);
    const { run } = this;
    const from = run?.parent ? `, from ${run.parent.name} at ${timeText(run.forkedAt * period, "", 3)}` : "";
    return `${timeText(samples * period, "", 3)}, ${touches.length} ${touches.length === 1 ? "action" : "actions"}${from} · ${titles.join(", then ")}`;
  }
}

export class RunList {
  private readonly rig: Rig;
  private readonly kept: KeptRuns;
  private entries: Entry[];

  constructor(rig: Rig, kept: KeptRuns) {
    this.rig = rig;
    this.kept = kept;
    this.entries = kept.read().map((each) => new Entry(each.id, each));
    this.learn();
  }

  /** Those that are pinned first, and the latest first. */
  get all(): Entry[] {
    const rank = (each: Entry): number => (each.isPinned ? 0 : 1);
    return [...this.entries].sort((one, other) => rank(one) - rank(other) || (one.id < other.id ? 1 : -1));
  }

  /** Runs that lie over the trends, in the order of their colours. */
  get overlaid(): Run[] {
    return this.entries.flatMap(({ run, isOver }) => (run && isOver && run !== this.rig.run ? [run] : []));
  }

  /** Let every run of the rig be in the list, each with a name of its own. */
  learn(): void {
    const { rig } = this;
    // A run in which nothing was done, as before a start of another kind, is none.
    rig.runs = rig.runs.filter((run) => run === rig.run || run.touches.length || run.samples > 1);
    this.entries = this.entries.filter(({ run }) => !run || rig.runs.includes(run));
    const known = new Set(this.entries.map(({ run }) => run));
    for (const run of rig.runs) {
      if (known.has(run)) continue;
      run.name = this.freeName(/^Run \d+$/.test(run.name) ? "Run 1" : run.name);
      this.entries.push(new Entry(newId(), run));
    }
  }

  /** Return a name, or one like it where it is taken. */
  freeName(name: string): string {
    const taken = new Set(this.entries.map((each) => each.name));
    const [, stem, count] = /^(.*?)(?: (\d+))?$/.exec(name)!;
    let free = name;
    for (let next = Number(count ?? 1) + 1; taken.has(free); ++next) free = `${stem} ${next}`;
    return free;
  }

  /** Keep what was done so far, and return whether there was room for all of it. */
  keep(): boolean {
    this.learn();
    return this.entries.map((each) => this.keepOne(each)).every(Boolean);
  }

  remove(entry: Entry): void {
    this.entries = this.entries.filter((each) => each !== entry);
    this.rig.runs = this.rig.runs.filter((run) => run !== entry.run);
    this.kept.remove(entry.id);
  }

  bringBack(entry: Entry): void {
    this.entries.push(entry);
    if (entry.run) this.rig.runs.push(entry.run);
  }

  private keepOne(entry: Entry): boolean {
    const { id, run, name, isPinned } = entry;
    if (run && ((!run.touches.length && !isPinned) || !run.samples)) return true;
    return this.kept.write({ id, name, isPinned, session: entry.session(this.rig) });
  }
}

let made = 0;

/** Return a word that sorts by the time at which it was made, and that no other page has. */
function newId(): string {
  const [time, place] = [Date.now().toString(36).padStart(9, "0"), (made++ % 1296).toString(36).padStart(2, "0")];
  return time + place + Math.random().toString(36).slice(2, 6);
}
