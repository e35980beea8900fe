/** Runs the scenario in a worker: one run at a time, and of what is asked meanwhile only the newest. */

import type { AnalysedMessage, LoadMessage, PageMessage, RanMessage, WorkerMessage } from "./messages.ts";

/** A run that has shown something makes way for a newer one after so long [ms]. */
const PATIENCE = 400;

export interface Trial {
  /** Its place among the controllers that can be tried. */
  controller: number;
  values: number[];
  /** Whether all settings are as they were. */
  isAsBefore: boolean;
}

export interface Listener {
  ran(trial: Trial, message: RanMessage): void;
  analysed(trial: Trial, message: AnalysedMessage): void;
  /** Why this trial ended early, or why none can be made; undefined where no worker runs. */
  refused(words: string | undefined, isFinal: boolean): void;
}

export class Runner {
  private readonly worker: Worker;
  private readonly listener: Listener;
  /** By run; the one before may still be analysed. */
  private readonly trials = new Map<number, Trial>();
  private runs = 0;
  private isReady = false;
  private isBusy = true;
  private waiting: Trial | undefined;
  private patience = 0;

  constructor(worker: Worker, load: LoadMessage, listener: Listener) {
    this.worker = worker;
    this.listener = listener;
    worker.addEventListener("message", ({ data }: MessageEvent<WorkerMessage>) => this.take(data));
    worker.addEventListener("error", () => listener.refused(undefined, true));
    this.post(load);
  }

  ask(trial: Trial): void {
    this.waiting = trial;
    this.next();
  }

  private next(): void {
    if (this.isBusy || !this.waiting) return;
    const { controller, values } = this.waiting;
    const run = this.runs;
    this.runs += 1;
    this.trials.set(run, this.waiting);
    this.trials.delete(run - 2);
    this.waiting = undefined;
    this.isBusy = true;
    this.post({ kind: "run", run, controller, values });
  }

  private take(message: WorkerMessage): void {
    if (message.kind === "ready") this.isReady = true;
    if (message.kind === "ran" && !message.whole) this.patience = setTimeout(() => this.free(), PATIENCE);
    else if (message.kind !== "analysed") this.free();
    if (message.kind === "refused") this.listener.refused(message.words, !this.isReady);
    if (message.kind === "ran" || message.kind === "analysed") {
      const trial = this.trials.get(message.run);
      if (trial && message.kind === "ran") this.listener.ran(trial, message);
      if (trial && message.kind === "analysed") this.listener.analysed(trial, message);
    }
    this.next();
  }

  private free(): void {
    clearTimeout(this.patience);
    this.isBusy = false;
    this.next();
  }

  private post(message: PageMessage): void {
    this.worker.postMessage(message);
  }
}
