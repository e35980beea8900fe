/** The alarms as an operator has them: a line each, until it has returned to normal and was acknowledged. */

import type { Acknowledging } from "./acknowledging.ts";
import { AlarmBadge } from "./alarm_badge.ts";
import { isThere, isWaiting, NORMAL, urgency } from "./alarm_states.ts";
import { AlarmTimes } from "./alarm_times.ts";
import type { AlarmData } from "./data.ts";
import { element } from "./faceplates.ts";
import { momentText } from "./quantities.ts";
import type { SeenRig } from "./seen_rig.ts";

export class AlarmList {
  private readonly rig: SeenRig;
  private readonly acknowledging: Acknowledging;
  private readonly list = element("ol", "");
  private readonly count = element("span", "count", "");
  private readonly nothing = element("li", "nothing", "No alarms.");
  private readonly all = element("button", "", "Acknowledge all");
  /** Told to who does not see it, once for each alarm that begins to wait. */
  private readonly spoken = element("p", "unseen", "");
  private readonly times: AlarmTimes;
  private readonly lines: Line[];
  private waiting: AlarmData[] = [];
  /** Whether a pointer is down on the list: a line that moved away would lose its click. */
  private isHeld = false;

  constructor(place: HTMLElement, rig: SeenRig, acknowledging: Acknowledging, changed: () => void) {
    this.rig = rig;
    this.acknowledging = acknowledging;
    this.times = new AlarmTimes(rig.data.alarms);
    const press = (...alarms: AlarmData[]): void => {
      acknowledging.press(...alarms);
      changed();
    };
    this.lines = rig.data.alarms.map((alarm) => new Line(alarm, () => press(alarm)));
    this.all.title = "Acknowledge every alarm (k)";
    this.all.addEventListener("click", () => press(...acknowledging.waiting));
    this.spoken.setAttribute("role", "status");
    // Who reads by keyboard scrolls it.
    this.list.tabIndex = 0;
    this.list.setAttribute("aria-label", "Alarms, the most urgent first");
    this.list.addEventListener("pointerdown", () => (this.isHeld = true));
    for (const kind of ["pointerup", "pointercancel"]) addEventListener(kind, () => (this.isHeld = false));
    const head = element("div", "head");
    head.append(element("h2", "", "Alarms"), this.count, this.all);
    place.append(head, this.list, this.spoken);
  }

  /** Acknowledge every alarm. */
  press(): void {
    this.all.click();
  }

  /** Show the alarms as they stand: those that wait first, then the most urgent, then the latest. */
  show(): void {
    const { acknowledging, rig } = this;
    this.times.read(rig.run, rig.sample);
    const { waiting } = acknowledging;
    const shown = this.lines.filter(({ alarm }) => acknowledging.state(alarm) !== NORMAL);
    const came = ({ alarm }: Line): number => this.times.of(alarm.name)?.came ?? 0;
    const rank = ({ alarm }: Line): number => Number(waiting.includes(alarm));
    shown.sort((one, other) => rank(other) - rank(one) || urgency(other.alarm) - urgency(one.alarm) || came(other) - came(one));
    for (const line of shown) this.write(line);
    this.place(shown.length ? shown.map(({ place }) => place) : [this.nothing]);
    this.all.disabled = waiting.length === 0;
    write(this.count, waiting.length ? `${waiting.length} to acknowledge` : "");
    this.speak(waiting);
  }

  private write(line: Line): void {
    const { acknowledging, rig } = this;
    const { alarm } = line;
    const state = acknowledging.state(alarm);
    const { came = 0, returned, times = 1 } = this.times.of(alarm.name) ?? {};
    const when = (sample: number): string => momentText(sample, rig.data.period);
    const isOpen = isWaiting(state) && !acknowledging.isPressed(alarm);
    line.tell({
      state, isOpen, came: when(came), times: times > 1 ? `${times} times` : "",
      words: isThere(state) ? (isOpen ? "unacknowledged" : "acknowledged") : `returned at ${when(returned ?? came)}`,
    });
  }

  /** Let lines stand in an order; who has a button of one in hand keeps it. */
  private place(lines: HTMLElement[]): void {
    if (this.isHeld) return;
    if (lines.length === this.list.children.length && lines.every((line, place) => this.list.children[place] === line)) return;
    const held = this.list.contains(document.activeElement) ? (document.activeElement as HTMLElement) : undefined;
    this.list.replaceChildren(...lines);
    if (held) (this.list.contains(held) ? held : this.list).focus();
  }

  private speak(waiting: AlarmData[]): void {
    const [alarm] = waiting.filter((each) => !this.waiting.includes(each)).sort((one, other) => urgency(other) - urgency(one));
    this.waiting = waiting;
    if (!alarm) return;
    const came = momentText(this.times.of(alarm.name)?.came ?? 0, this.rig.data.period);
    this.spoken.textContent = `${alarm.words}, ${alarm.priority} priority, at ${came}; ${waiting.length} to acknowledge`;
  }
}

interface Told {
  state: number;
  isOpen: boolean;
  came: string;
  times: string;
  words: string;
}

/** A line of the list. */
class Line {
  readonly alarm: AlarmData;
  readonly place = element("li", "");
  private readonly badge: AlarmBadge;
  private readonly came = element("span", "when", "");
  private readonly state = element("span", "state", "");
  private readonly times = element("span", "times", "");
  private readonly button = element("button", "", "Acknowledge");

  constructor(alarm: AlarmData, press: () => void) {
    this.alarm = alarm;
    this.badge = new AlarmBadge(alarm);
    this.button.setAttribute("aria-label", `Acknowledge ${alarm.words}`);
    this.button.addEventListener("click", press);
    this.place.append(this.badge.place, this.came, element("span", "words", alarm.words), this.times, this.state, this.button);
  }

  tell({ state, isOpen, came, times, words }: Told): void {
    this.badge.show(state);
    this.place.classList.toggle("waiting", isOpen);
    write(this.came, came);
    write(this.times, times);
    write(this.state, words);
    if (this.button.hidden === isOpen) {
      const isHeld = document.activeElement === this.button;
      this.button.hidden = !isOpen;
      if (isHeld) this.place.parentElement?.focus();
    }
  }
}

function write(place: HTMLElement, words: string): void {
  if (place.textContent !== words) place.textContent = words;
}
