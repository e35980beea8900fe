/** What has tripped, and why: told above the rig as long as it stands, and in one line where it comes again and again. */

import type { EventData, PlantData } from "./data.ts";
import type { Run } from "./run.ts";

type Value = (name: string) => number;

/** Trips no further apart than so many samples belong together. */
const TOGETHER = 1000;
/** They are told for so many times as long as it was between the last two. */
const PATIENCE = 2;

/** Return why an input is tripped, "tripped: tank_4 above 27.5 cm"; "" where it is not. */
export function tripWords(name: string, events: EventData[], value: Value): string {
  return value(`${name}.tripped`) === 1 ? lastTrip(name, events, value) : "";
}

/** Return why an input tripped the last time. */
function lastTrip(name: string, events: EventData[], value: Value): string {
  const time = ({ count }: EventData): number => value(count.replace(/count$/, "time"));
  const trips = events.filter(({ count }) => isTripOf(name, count) && value(count) > 0);
  const [last] = trips.sort((one, other) => time(other) - time(one));
  return last ? last.words.replace(/^.*? trips/, "tripped") : "tripped";
}

function isTripOf(name: string, count: string): boolean {
  return count.startsWith(`${name}.trips`);
}

/** The samples in which an input tripped the last two times, and how often it did without a long rest. */
interface Trips {
  last: number;
  before: number;
  times: number;
}

/** The trips of each input of a run, up to a sample. */
export class TripTimes {
  private readonly inputs: string[];
  private readonly known = new Map<string, Trips>();
  private run: Run | undefined;
  private sample = 0;
  private happened = 0;

  constructor({ inputs }: Pick<PlantData, "inputs">) {
    this.inputs = inputs;
  }

  /** Read what a run has up to a sample. */
  read(run: Run, sample: number): void {
    if (run !== this.run || sample < this.sample) {
      this.run = run;
      this.known.clear();
      this.happened = 0;
    }
    this.sample = sample;
    for (let found; (found = run.happened[this.happened]) && found.sample < sample; this.happened += 1) {
      const { kind, of } = found;
      const input = kind === "event" && this.inputs.find((name) => isTripOf(name, of));
      if (input) this.add(input, found.sample);
    }
  }

  /** Return how often an input tripped again and again up to now; 0 where it does not. */
  repeated(input: string): number {
    const { last, before, times } = this.known.get(input) ?? { last: 0, before: 0, times: 0 };
    return times > 1 && this.sample - last <= PATIENCE * (last - before) ? times : 0;
  }

  private add(input: string, sample: number): void {
    const before = this.known.get(input);
    const isNear = before !== undefined && sample - before.last <= TOGETHER;
    this.known.set(input, { last: sample, before: before?.last ?? sample, times: isNear ? before.times + 1 : 1 });
  }
}

/** The banner: a line for each input that is tripped, or trips again and again. */
export class TripBanner {
  private readonly place: HTMLElement;
  private readonly data: PlantData;
  private readonly times: TripTimes;

  constructor(place: HTMLElement, data: PlantData) {
    this.place = place;
    this.data = data;
    this.times = new TripTimes(data);
  }

  show(run: Run, sample: number, value: Value): void {
    const { data, place, times } = this;
    times.read(run, sample);
    const lines = data.inputs.flatMap((name) => {
      const repeated = times.repeated(name);
      if (value(`${name}.tripped`) !== 1 && !repeated) return [];
      return [{ words: `${name} ${lastTrip(name, data.events, value)}`, count: repeated ? ` (${repeated} times)` : "" }];
    });
    place.hidden = lines.length === 0;
    while (place.children.length > lines.length) place.lastElementChild!.remove();
    lines.forEach(({ words, count }, number) => {
      const line = place.children[number] ?? place.appendChild(lineOf());
      write(line.firstElementChild!, words);
      write(line.lastElementChild!, count);
    });
  }
}

/** Return a line whose count is not told anew to who does not see it. */
function lineOf(): HTMLElement {
  const [line, words, count] = ["span", "span", "span"].map((tag) => document.createElement(tag)) as [HTMLElement, HTMLElement, HTMLElement];
  line.className = "trip";
  count.setAttribute("aria-hidden", "true");
  line.append(words, count);
  return line;
}

function write(place: Element, words: string): void {
  if (place.textContent !== words) place.textContent = words;
}
