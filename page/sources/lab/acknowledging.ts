/** An operator who acknowledges alarms: each by a press that lasts one sample. */

import { alarmState, isWaiting } from "./alarm_states.ts";
import type { AlarmData } from "./data.ts";
import type { SeenRig } from "./seen_rig.ts";

const [RELEASED, PRESSED] = [0, 1];

export class Acknowledging {
  private readonly rig: SeenRig;

  constructor(rig: SeenRig) {
    this.rig = rig;
  }

  /** The alarms that nobody has acknowledged. */
  get waiting(): AlarmData[] {
    return this.rig.data.alarms.filter((alarm) => isWaiting(this.state(alarm)) && !this.isPressed(alarm));
  }

  state(alarm: AlarmData): number {
    return alarmState(alarm, (name) => this.rig.value(name));
  }

  /** Tell whether an alarm is acknowledged in the sample to come. */
  isPressed(alarm: AlarmData): boolean {
    return this.rig.asked(port(alarm)) === PRESSED;
  }

  press(...alarms: AlarmData[]): void {
    for (const alarm of alarms) this.rig.touch(port(alarm), PRESSED);
  }

  /** Before a sample: let go of what was pressed for the one before, since a press that lasts acts once. */
  step(): void {
    for (const alarm of this.rig.data.alarms)
      if (!this.isPressed(alarm) && this.rig.value(port(alarm)) === PRESSED) this.rig.touch(port(alarm), RELEASED);
  }
}

/** Return the input that acknowledges an alarm. */
export function port({ name }: AlarmData): string {
  return `${name}.acknowledge`;
}
