/** What happens on the rig by itself: trips, alarms, rims, dry tanks, spilling, limits and faults, as each begins. */

import { alarmState, isThere } from "./alarm_states.ts";
import type { AlarmData, PlantData, ShownSignal } from "./data.ts";
import { share } from "./quantities.ts";
import { levelWords, statusWords } from "./states.ts";

type Value = (name: string) => number;
type Found = Pick<Happening, "words" | "isAbnormal" | "of">;
/** Looks at a sample, and returns what it finds that was not so in the one before. */
type Watch = (value: Value) => Found | undefined;

/** Something that happened in a sample, and of what. */
export interface Happening {
  sample: number;
  kind: "event" | "alarm" | "return" | "level" | "spill" | "limit";
  of: string;
  words: string;
  isAbnormal: boolean;
}

export class Watches {
  private readonly watches: [kind: Happening["kind"], Watch[]][];

  constructor(data: PlantData) {
    const signals = new Map(data.signals.map((each) => [each.name, each]));
    const watches: Record<Happening["kind"], Watch[]> = {
      event: data.events.map(({ count, words, isHarm }) => counted(count, words, isHarm)),
      alarm: data.alarms.map((alarm) => comes(alarm)),
      return: data.alarms.map((alarm) => returns(alarm)),
      level: data.levels.map((name) => level(signals.get(name)!)),
      spill: data.spills.map(({ tank, total }) => grows(total, tank)),
      limit: data.inputs.map((name) => status(name)),
    };
    this.watches = Object.entries(watches) as [Happening["kind"], Watch[]][];
  }

  /** Look at a sample, and return what happened in it. */
  look(value: Value, sample: number): Happening[] {
    const found: Happening[] = [];
    for (const [kind, watches] of this.watches)
      for (const watch of watches) {
        const happened = watch(value);
        if (happened) found.push({ sample, kind, ...happened });
      }
    return found;
  }
}

/** An output that counts. */
function counted(count: string, words: string, isAbnormal: boolean): Watch {
  let before = Infinity;
  return (value) => {
    const now = value(count);
    const happened = now > before;
    before = now;
    return happened ? { words, isAbnormal, of: count } : undefined;
  };
}

/** An alarm that comes, in the first sample of a run too. */
function comes(alarm: AlarmData): Watch {
  let was = false;
  return (value) => {
    const is = isThere(alarmState(alarm, value));
    const isNew = is && !was;
    was = is;
    return isNew ? { words: alarm.words, isAbnormal: true, of: alarm.name } : undefined;
  };
}

/** An alarm that returns to normal. */
function returns(alarm: AlarmData): Watch {
  let was = false;
  return (value) => {
    const is = isThere(alarmState(alarm, value));
    const isGone = was && !is;
    was = is;
    return isGone ? { words: `${alarm.words} returned to normal`, isAbnormal: false, of: alarm.name } : undefined;
  };
}

/** A total that begins to grow. */
function grows(total: string, tank: string): Watch {
  let [before, was] = [Infinity, false];
  return (value) => {
    const now = value(total);
    const isGrowing = now > before;
    const begins = isGrowing && !was;
    [before, was] = [now, isGrowing];
    return begins ? { words: `${tank} spills`, isAbnormal: true, of: tank } : undefined;
  };
}

/** A tank that becomes full, or empty. */
function level(signal: ShownSignal): Watch {
  const tank = signal.name.slice(0, signal.name.lastIndexOf("."));
  return begins(tank, (value) => levelWords(share(signal, value(signal.name))), (words) => `${tank} is ${words}`);
}

/** An output that comes to a limit, that an alarm holds, or whose law has a fault. */
function status(name: string): Watch {
  const state = (value: Value): string => (value(`${name}.interlock`) > 0 ? "held by an interlock" : statusWords(value(`${name}.status`)));
  return begins(name, state, (words) => `${name}: ${words}`);
}

/** Words that are others than in the sample before, and say something. */
function begins(of: string, state: (value: Value) => string, told: (words: string) => string): Watch {
  let before: string | undefined;
  return (value) => {
    const now = state(value);
    const isNew = before !== undefined && now !== before && now !== "";
    before = now;
    return isNew ? { words: told(now), isAbnormal: true, of } : undefined;
  };
}
