/** A rig that runs elsewhere: its samples come by a link, and what hands do goes there. */

import type { AttachedData, Hand } from "../data.ts";
import { History } from "../history.ts";
import { Run } from "../run.ts";
import type { SeenRig } from "../seen_rig.ts";
import { WIRES } from "../touch_words.ts";
import { type Happening, Watches } from "../watches.ts";
import { cellOf, NOISE } from "./cells.ts";
import { Changes } from "./changes.ts";
import type { Hello } from "./link.ts";
import type { Heard } from "./standing.ts";

/** Before its columns a row has its sample and its time. */
const HEAD = 2;
/** Numbers that the history holds at most, and samples at least: some 128 MB. */
const [MOST, FEWEST] = [1 << 24, 1 << 14];

const [HEARD, WRITES] = ["controller.heard", "controller.writes"];

export class AttachedRig implements SeenRig {
  readonly data: AttachedData;
  readonly controller = 0;
  run!: Run;
  sample = 0;
  /** Takes what hands do to where the plant is. */
  private readonly send: (hand: Hand) => void;
  private columns: string[] = [];
  private places = new Map<string, number>();
  private changes!: Changes;
  private watches!: Watches;
  /** The last sample that came. */
  private last: Float64Array | undefined;
  /** What hands have set and is not seen in a sample yet, with the sample in which it is to be seen. */
  private readonly waiting = new Map<string, { hand: Hand; value: number; seenIn: number }>();
  private start = "";
  /** Whether what comes goes on with what there is: else the next sample tells, which came before. */
  private isProven = false;
  private readonly parameters: Map<string, number>;
  private out: { sample: number; values: number[] } = { sample: -1, values: [] };

  constructor(data: AttachedData, send: (hand: Hand) => void) {
    this.data = data;
    this.send = send;
    this.parameters = new Map(data.controllers[0]!.parameters);
  }

  /** The last sample that came; the rig sends those behind the one before, so that this one tells whether it goes on. */
  get lastSample(): number | undefined {
    return this.last?.[0];
  }

  get hasSamples(): boolean {
    return this.last !== undefined;
  }

  /** Whether it is seen as it was, and not as it is. */
  get isPast(): boolean {
    return this.sample < this.run.history.count;
  }

  /** Learn what rows hold, and of which start of the rig they are. */
  meet({ columns, start }: Hello): void {
    if (columns.join() !== this.columns.join()) this.last = undefined;
    this.columns = columns;
    this.isProven = start === this.start;
    this.start = start;
    // What the plant tells comes before what moves it.
    this.places = new Map([...columns].reverse().map((name, place) => [name, columns.length - 1 - place]));
    this.changes = new Changes(this.data, columns);
    this.waiting.clear();
  }

  /** Take samples as they come. */
  take(rows: Float64Array): void {
    const width = HEAD + this.columns.length;
    for (let start = 0; start + width <= rows.length; start += width) this.takeOne(rows.subarray(start, start + width));
  }

  touch(input: string, value: number): void {
    if (!Number.isFinite(value)) throw new RangeError(`${input}: ${value}`);
    this.ask(input, value, { input, value: value + 0 });
  }

  noise(isOn: boolean): void {
    this.ask(NOISE, Number(isOn), { noise: isOn });
  }

  drift(measurement: string, rate: number): void {
    this.ask(`${measurement}.drift`, rate, { drift: measurement, rate });
  }

  /** The plant has taken it: it is seen in a sample behind this one at the latest. */
  taken(hand: Hand, sample: number): void {
    const found = this.waiting.get(cellOf(hand));
    if (found?.hand === hand) found.seenIn = sample + 1;
  }

  refused(hand: Hand): void {
    const cell = cellOf(hand);
    if (this.waiting.get(cell)?.hand === hand) this.waiting.delete(cell);
  }

  /** Know what comes out of the delays behind a sample. */
  comesOut(sample: number, values: number[]): void {
    this.out = { sample, values };
  }

  goTo(sample: number): void {
    const { first, count } = this.run.history;
    this.sample = Math.min(Math.max(sample, first + 1), count);
  }

  value(name: string): number {
    return this.asked(name) ?? this.run.history.value(name, this.sample - 1);
  }

  /** Return what is so now, whatever moment is seen. */
  now(name: string): number {
    return this.waiting.get(name)?.value ?? this.run.history.value(name, this.run.history.count - 1);
  }

  asked(input: string): number | undefined {
    return this.isPast ? undefined : this.waiting.get(input)?.value;
  }

  parameter(name: string): number {
    return this.parameters.get(name) ?? NaN;
  }

  setting(_controller: number, name: string): number {
    return this.parameter(name);
  }

  delayed(): number[] {
    const { sample, values } = this.out;
    // Of other moments nobody knows.
    return sample === this.sample - 1 ? values : values.map(() => NaN);
  }

  drifting(measurement: string): number {
    return this.value(`${measurement}.drift`);
  }

  /** Whether the controller on the wires moves the plant, now. */
  get isRemote(): boolean {
    return this.now(WIRES.remote) !== 0;
  }

  /** Whether it is heard, now; before it has written anything nobody misses it. */
  get heard(): Heard {
    if (this.now(HEARD) === 0) return "silent";
    return this.now(WRITES) === 0 ? "none" : "heard";
  }

  private ask(cell: string, value: number, hand: Hand): void {
    this.waiting.set(cell, { hand, value, seenIn: Infinity });
    this.send(hand);
  }

  private takeOne(row: Float64Array): void {
    const { last } = this;
    const sample = row[0]!;
    const isKnown = last && sample === last[0] && row[1] === last[1];
    this.isProven ||= isKnown === true;
    if (isKnown) return;
    const missing = last && this.isProven ? sample - last[0]! - 1 : -1;
    const isNew = missing < 0 || missing > this.capacity;
    const isFollowing = isNew || !this.isPast;
    if (isNew) this.begin(sample);
    else if (missing) {
      for (let left = missing; left > 0; --left) this.run.history.add(() => NaN);
      this.watches = new Watches(this.data);
    }
    const at = (from: Float64Array) => (name: string): number => from[HEAD + this.places.get(name)!] ?? NaN;
    const { run } = this;
    if (last && !isNew) {
      run.touches.push(...this.changes.between(at(last), at(row), sample));
      run.happened.push(...this.turned(at(last)(HEARD), at(row)(HEARD), sample));
    }
    run.history.add((column) => row[HEAD + column]!);
    run.samples = run.history.count;
    run.happened.push(...this.watches.look(at(row), sample));
    if (isFollowing) this.sample = run.history.count;
    for (const [name, { seenIn }] of this.waiting) if (seenIn <= sample) this.waiting.delete(name);
    // The numbers of many samples lie in one piece of memory.
    this.last = row.slice();
  }

  private get capacity(): number {
    return Math.max(FEWEST, Math.floor(MOST / this.columns.length));
  }

  private begin(sample: number): void {
    this.run = new Run("Live", "rest", new History(this.columns, this.capacity, sample), 0);
    this.watches = new Watches(this.data);
    this.isProven = true;
  }

  private turned(before: number, now: number, sample: number): Happening[] {
    if (before === now) return [];
    const words = now ? "the controller on the wires is heard" : "the controller on the wires is silent";
    return [{ sample, kind: "limit", of: HEARD, words, isAbnormal: !now }];
  }
}
