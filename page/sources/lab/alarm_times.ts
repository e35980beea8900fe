/** When each alarm of a run came and returned at last, and how often it came since it was acknowledged. */

import { port } from "./acknowledging.ts";
import type { AlarmData, Touch } from "./data.ts";
import type { Run } from "./run.ts";
import { RunReader } from "./run_reader.ts";
import type { Happening } from "./watches.ts";

export interface Times {
  /** The samples in which it came and, if it did since, returned. */
  came: number;
  returned: number | undefined;
  times: number;
}

export class AlarmTimes {
  /** The input that acknowledges an alarm, to the alarm. */
  private readonly ports: Map<string, string>;
  private readonly known = new Map<string, Times & { isAcknowledged: boolean }>();
  private readonly reader = new RunReader({
    begin: () => this.known.clear(),
    touched: (touch) => this.answer(touch),
    happened: (happening) => this.look(happening),
  });

  constructor(alarms: AlarmData[]) {
    this.ports = new Map(alarms.map((alarm) => [port(alarm), alarm.name]));
  }

  /** Read what a run has up to a sample. */
  read(run: Run, sample: number): void {
    this.reader.read(run, sample);
  }

  /** Return those of an alarm; undefined where it never came. */
  of(alarm: string): Times | undefined {
    return this.known.get(alarm);
  }

  private answer(touch: Touch): void {
    const alarm = "input" in touch && touch.value ? this.ports.get(touch.input) : undefined;
    if (alarm) this.acknowledge(alarm);
  }

  private look({ kind, of, sample }: Happening): void {
    const known = this.known.get(of);
    if (kind === "alarm") this.come(of, sample);
    if (kind === "return" && known) known.returned = sample;
  }

  private come(alarm: string, sample: number): void {
    const before = this.known.get(alarm);
    const times = before && !before.isAcknowledged ? before.times + 1 : 1;
    this.known.set(alarm, { came: sample, returned: undefined, times, isAcknowledged: false });
  }

  private acknowledge(alarm: string): void {
    const known = this.known.get(alarm);
    if (known) known.isAcknowledged = true;
  }
}
