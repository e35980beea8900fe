/** The log of a run: what hands did and what happened; what comes again and again is one line with its times. */

import type { PlantData } from "./data.ts";
import type { Run } from "./run.ts";
import { RunReader } from "./run_reader.ts";
import { type TouchLine, TouchWords } from "./touch_words.ts";
import type { Happening } from "./watches.ts";

/** Lines that are told: the latest ones. */
const LINES = 100;
/** Moves of a slider that are no further apart than so many samples are one. */
const SLID = 100;

export interface LogLine {
  words: string;
  isAbnormal: boolean;
  /** The samples in which it happened first and last. */
  first: number;
  sample: number;
  times: number;
}

export class Log {
  /** Changes with the lines. */
  version = 0;
  /** The latest one last. */
  private lines: LogLine[] = [];
  /** What happened since a hand did something, by its words. */
  private readonly since = new Map<string, LogLine>();
  /** What a hand did last, while nothing else has happened. */
  private newest: { key: string; line: LogLine } | undefined;
  private readonly told: TouchWords;
  private readonly reader = new RunReader({
    begin: () => this.begin(),
    touched: (touch) => {
      for (const line of this.told.of(touch)) this.addTouch(line, touch.sample);
    },
    happened: (happening) => this.addHappening(happening),
  });

  constructor(data: PlantData, titled: (controller: string) => string) {
    this.told = new TouchWords(data, titled);
  }

  /** The latest lines, the last one first. */
  get latest(): LogLine[] {
    return this.lines.slice(-LINES).reverse();
  }

  /** Read what a run has up to a sample. */
  read(run: Run, sample: number): void {
    this.reader.read(run, sample);
  }

  private begin(): void {
    this.lines = [];
    this.since.clear();
    this.newest = undefined;
    this.version += 1;
  }

  /** Add what a hand did; what a slider does on and on is one line, with its last words. */
  private addTouch({ key, words, isAbnormal, isSlid }: TouchLine, sample: number): void {
    const { newest } = this;
    const isSame = newest?.key === key;
    this.since.clear();
    this.version += 1;
    if (isSame && isSlid && sample - newest.line.sample <= SLID) Object.assign(newest.line, { words, sample });
    else if (isSame && newest.line.words === words) again(newest.line, sample);
    else this.newest = { key, line: this.add(words, isAbnormal, sample) };
  }

  /** Add what happened, to its line where it did so before and no hand did anything in between. */
  private addHappening({ words, isAbnormal, sample }: Happening): void {
    const known = this.since.get(words);
    this.newest = undefined;
    this.version += 1;
    if (known) again(known, sample);
    else this.since.set(words, this.add(words, isAbnormal, sample));
  }

  private add(words: string, isAbnormal: boolean, sample: number): LogLine {
    const line = { words, isAbnormal, first: sample, sample, times: 1 };
    this.lines.push(line);
    return line;
  }
}

function again(line: LogLine, sample: number): void {
  line.sample = sample;
  line.times += 1;
}
