/** Sliders of a controller: softer to bolder, and each setting with a field for its number. */

import { numberText, timeText } from "../words.ts";
import type { LiveSetting } from "./messages.ts";
import type { TriedSettings } from "./tried_settings.ts";

/** Steps of a slider: an arrow key is one, about 1.4 % of a gain. */
const STEPS = 200;
/** From a quarter of the gains to four times. */
const BOLDEST = 4;
/** Digits of what a slider sets. */
const DIGITS = 3;

export class Sliders {
  readonly place = document.createElement("div");
  private readonly refreshers: (() => void)[] = [];
  private readonly tried: TriedSettings;
  private readonly moved: () => void;

  constructor(tried: TriedSettings, moved: () => void) {
    this.tried = tried;
    this.moved = moved;
    const { bolder, loops } = tried.controller;
    this.place.className = "loops";
    if (bolder.length) this.place.append(this.boldness());
    for (const { title, settings } of loops) {
      const group = document.createElement("div");
      group.className = "loop";
      const words = document.createElement("p");
      words.className = "unit";
      words.textContent = title;
      group.append(words, ...settings.flatMap((each) => this.row(each, title)));
      this.place.append(group);
    }
    this.refresh();
  }

  /** Let all of them stand at what is tried. */
  refresh(): void {
    for (const refresh of this.refreshers) refresh();
  }

  private boldness(): HTMLElement {
    const { tried } = this;
    const group = document.createElement("div");
    group.className = "boldness";
    const words = document.createElement("span");
    words.className = "factor";
    const scale = new Scale(1 / BOLDEST, BOLDEST, 1, true);
    const input = slider("All gains, softer to bolder", scale, (factor) => {
      tried.bolder = factor;
      this.refresh();
      this.moved();
    });
    const [softer, bolder] = ["softer", "bolder"].map((end) => {
      const span = document.createElement("span");
      span.className = "unit";
      span.textContent = end;
      return span;
    });
    group.append(softer!, marked(input, scale), bolder!, words);
    this.refreshers.push(() => {
      words.textContent = `gains × ${numberText(tried.bolder, DIGITS)}`;
      stand(input, scale, tried.bolder, words.textContent);
    });
    return group;
  }

  private row(setting: LiveSetting, loop: string): HTMLElement[] {
    const { tried } = this;
    const { symbol, words, unit, low, high, value, logarithmic } = setting;
    const name = document.createElement("span");
    name.textContent = symbol;
    name.title = words;
    const label = `${symbol}, ${words}, ${loop}`;
    const scale = new Scale(low, high, value, logarithmic);
    const take = (shown: number) => {
      tried.set(setting, shown);
      refused.hidden = true;
      field.removeAttribute("aria-invalid");
      this.refresh();
      this.moved();
    };
    const input = slider(label, scale, take);
    const field = document.createElement("input");
    field.type = "text";
    field.inputMode = "decimal";
    field.autocomplete = "off";
    field.setAttribute("aria-label", unit ? `${label} [${unit}]` : label);
    const refused = document.createElement("p");
    refused.className = "refused";
    refused.id = `refused-${(refusals += 1)}`;
    refused.setAttribute("role", "alert");
    field.setAttribute("aria-describedby", refused.id);
    field.addEventListener("change", () => {
      const typed = Number(field.value.trim().replace(",", ".").replace("−", "-") || NaN);
      if (typed >= setting.least && typed <= setting.most) return take(typed);
      refused.textContent = boundsText(setting);
      refused.hidden = false;
      field.setAttribute("aria-invalid", "true");
    });
    const told = document.createElement("span");
    told.className = "unit";
    this.refreshers.push(() => {
      const shown = tried.shown(setting);
      stand(input, scale, shown, `${numberText(shown)} ${unit}`.trim());
      told.textContent = unitText(unit, shown);
      if (field.hasAttribute("aria-invalid") && document.activeElement === field) return;
      refused.hidden = true;
      field.removeAttribute("aria-invalid");
      field.value = numberText(shown).replace("−", "-");
    });
    return [name, marked(input, scale), field, told, refused];
  }
}

let refusals = 0;

/** Where numbers stand on a slider. */
class Scale {
  readonly low: number;
  readonly high: number;
  /** As the study has it: the step nearest to it is it. */
  readonly before: number;
  readonly logarithmic: boolean;

  constructor(low: number, high: number, before: number, logarithmic: boolean) {
    [this.low, this.high, this.before, this.logarithmic] = [low, high, before, logarithmic];
  }

  /** Return which share of the way up a number is. */
  share(value: number): number {
    const { low, high } = this;
    const share = this.logarithmic ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
    return Math.min(1, Math.max(0, share));
  }

  step(value: number): number {
    return Math.round(STEPS * this.share(value));
  }

  at(step: number): number {
    if (step === this.step(this.before)) return this.before;
    const { low, high } = this;
    const share = step / STEPS;
    return Number((this.logarithmic ? low * (high / low) ** share : low + (high - low) * share).toPrecision(DIGITS));
  }
}

function slider(label: string, scale: Scale, take: (value: number) => void): HTMLInputElement {
  const input = document.createElement("input");
  input.type = "range";
  input.min = "0";
  input.max = String(STEPS);
  input.setAttribute("aria-label", label);
  input.addEventListener("input", () => take(scale.at(Number(input.value))));
  return input;
}

function stand(input: HTMLInputElement, scale: Scale, value: number, words: string): void {
  input.value = String(scale.step(value));
  input.setAttribute("aria-valuetext", words);
}

/** Return a slider with a mark at what the study has. */
function marked(input: HTMLInputElement, scale: Scale): HTMLElement {
  const track = document.createElement("span");
  track.className = "track";
  track.style.setProperty("--mark", String(scale.share(scale.before)));
  track.append(input);
  return track;
}

/** Return a unit, of a long time with the same in minutes or more; a gain's may part where it divides. */
function unitText(unit: string, shown: number): string {
  const long = unit === "s" && timeText(shown, "", DIGITS);
  return long && !long.endsWith(" s") ? `s = ${long}` : unit.replaceAll(")/", ")/\u200b");
}

function boundsText({ least, most, unit }: LiveSetting): string {
  const [low, high] = [least, most].map((each) => {
    const isPlain = each === 0 || (Math.abs(each) >= 1e-3 && Math.abs(each) < 1e6);
    const text = isPlain ? numberText(each) : each.toExponential().replace("e+", "e").replaceAll("-", "−");
    return `${text} ${unit}`.trim();
  });
  return `A number from ${low} to ${high}.`;
}
