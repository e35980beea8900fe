/** The mark of an alarm: its letters, in the colour and the form of its priority, full as long as nobody has acknowledged it. */

import { isWaiting, NORMAL } from "./alarm_states.ts";
import type { AlarmData } from "./data.ts";

export class AlarmBadge {
  readonly place = document.createElement("span");
  private state = NaN;

  constructor(alarm: AlarmData) {
    this.place.className = `alarm-badge ${alarm.priority}`;
    this.place.textContent = alarm.short;
    this.place.setAttribute("role", "img");
    this.place.setAttribute("aria-label", `${alarm.words}, ${alarm.priority} priority`);
    this.place.title = this.place.getAttribute("aria-label")!;
    this.show(NORMAL);
  }

  /** Show a state; what is normal has no mark. */
  show(state: number): void {
    if (state === this.state) return;
    this.state = state;
    this.place.hidden = state === NORMAL;
    this.place.classList.toggle("waiting", isWaiting(state));
  }
}
