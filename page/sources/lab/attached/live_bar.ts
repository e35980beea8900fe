/** The bar above a running rig: who moves it, how it stands, noise, and back to now. */

import { numberText, timeText } from "../../words.ts";
import { element } from "../faceplates.ts";
import { showPressed } from "../hands.ts";
import { acting } from "./acting.ts";
import type { Heard } from "./standing.ts";

const HEARD_WORDS: Record<Heard, string> = { none: "No controller yet", heard: "Controller heard", silent: "Controller silent" };

export interface LiveHandler {
  /** Let the controller on the wires move the plant, or the rig's local panel. */
  remote(isRemote: boolean): void;
  noise(isOn: boolean): void;
  /** See the plant as it is. */
  now(): void;
}

export interface LiveShown {
  /** Of the plant, where it is seen [s]. */
  time: number;
  speed: number;
  isRemote: boolean;
  heard: Heard;
  isNoisy: boolean;
  isPast: boolean;
  isStale: boolean;
  pages: number;
  /** By which the last sample began too late, and a period, as the clock on the wall has them [s]. */
  lateness: number;
  period: number;
  /** Periods that were left out since the plant was started. */
  missed: number;
}

export class LiveBar {
  /** Its switches; disabled while hands may not move the plant. */
  readonly switches: HTMLFieldSetElement;
  private readonly told = element("span", "told", "");
  private readonly heard = element("span", "chip heard", "");
  private readonly link = element("span", "chip", "");
  private readonly now = element("button", "", "Now");
  private readonly noise = Object.assign(element("input", ""), { type: "checkbox" });
  private readonly modes: [button: HTMLButtonElement, isRemote: boolean][];

  constructor(place: HTMLElement, handler: LiveHandler) {
    const modes = element("div", "modes");
    modes.setAttribute("role", "group");
    modes.setAttribute("aria-label", "Who moves the plant");
    this.modes = ([["Remote", true], ["Local", false]] as const).map(([words, isRemote]) => {
      const button = element("button", "", words);
      button.title = isRemote ? "The controller on the wires moves the plant" : "The rig's own controller moves the plant, by its local panel";
      button.addEventListener("click", () => handler.remote(isRemote));
      modes.append(button);
      return [button, isRemote];
    });
    const noise = element("label", "", "Noise ");
    this.noise.addEventListener("change", () => handler.noise(this.noise.checked));
    noise.append(this.noise);
    this.now.title = "See the plant as it is";
    this.now.addEventListener("click", () => handler.now());
    this.switches = acting(place);
    this.switches.append(modes, noise);
    place.append(this.heard, this.now, this.link, this.told);
  }

  /** Press what a key stands for. */
  pressNoise(): void {
    this.noise.click();
  }

  show({ time, speed, isRemote, heard, isNoisy, isPast, isStale, pages, lateness, period, missed }: LiveShown): void {
    for (const [button, is] of this.modes) showPressed(button, is === isRemote);
    this.noise.checked = isNoisy;
    this.now.hidden = !isPast;
    write(this.heard, HEARD_WORDS[heard]);
    this.heard.classList.toggle("off", heard === "none");
    this.heard.classList.toggle("alarming", heard === "silent" && isRemote);
    const late = lateness > period ? ["samples come late"] : [];
    const also = pages > 1 ? [`${pages} pages`] : [];
    write(this.link, isStale ? "Not live" : ["Live", ...late, ...also].join(", "));
    const left = missed ? `; ${missed} periods were left out since the plant was started` : "";
    this.link.title = `The last sample began ${numberText(1000 * lateness, 2)} ms late${left}`;
    this.link.classList.toggle("alarming", isStale);
    const pace = speed === 1 ? "" : `, ${numberText(speed, 3)} times real time`;
    write(this.told, timeText(time) + pace + (isPast ? ", as it was" : ""));
  }
}

function write(place: HTMLElement, words: string): void {
  if (place.textContent !== words) place.textContent = words;
}
