/** A stretch of a run for `clepsydra identify`: the record, and the command to run. */

import { copyOnClick } from "../copy";
import type { PlantData } from "./data.ts";
import { element } from "./faceplates.ts";
import { doubtOf } from "./recorder.ts";
import type { Past } from "./thinned.ts";

export interface Marked {
  past: Past;
  stretch: [number, number];
  /** Of the record. */
  file: string;
}

export class Identify {
  readonly place = element("details", "identify");
  private readonly moved: HTMLSelectElement;
  private readonly measured: HTMLSelectElement;
  private readonly command = element("code", "", "");
  private readonly doubt = element("p", "", "");
  private readonly marked: () => Marked;
  private readonly process: string;
  private readonly inputs: string[];
  /** Numbers of the plant. */
  private readonly fitted = new Set<string>();

  constructor(data: PlantData, marked: () => Marked, save: () => void) {
    this.marked = marked;
    this.process = data.process;
    this.inputs = [...data.inputs, ...data.disturbances];
    const [moved, movedLabel] = choice("What moves ", [...data.inputs, ...data.disturbances, ...data.controlled.map((name) => `${name}.setpoint`)]);
    const [measured, measuredLabel] = choice("What follows ", data.measurements);
    [this.moved, this.measured] = [moved, measured];
    const copy = element("button", "", "Copy the command");
    copyOnClick(copy, () => this.command.textContent!);
    const record = element("button", "", "Save its record");
    record.addEventListener("click", save);
    const line = element("p", "command");
    line.append(this.command);
    const tools = element("div", "tools");
    tools.append(movedLabel, measuredLabel, record, copy);
    const words = "A step of what moves between the cursors shows what the process does. Save the record, and run the command where it was saved; the settings that it prints can be typed into a loop.";
    this.place.append(element("summary", "", "Identify a model from what is between the cursors"), element("p", "note", words), tools,
      this.numbers(data.parameters.map(({ name }) => name)), line, this.doubt);
    for (const select of [moved, measured]) select.addEventListener("change", () => this.show());
    this.place.addEventListener("toggle", () => this.show());
  }

  /** Tell the command, and what it would refuse. */
  show(): void {
    if (!this.place.open) return;
    const { past, stretch: [first, last], file } = this.marked();
    const pair = `--manipulated ${this.moved.value} --measured ${this.measured.value}`;
    const fit = `--process ${quoted(this.process)} --parameters ${[...this.fitted].join(",")}`;
    const command = `clepsydra identify ${quoted(file)} ${this.fitted.size ? fit : pair}`;
    if (this.command.textContent !== command) this.command.textContent = command;
    const doubt = doubtOf(past, first, last, this.fitted.size ? this.inputs : [this.moved.value]);
    if (this.doubt.textContent !== doubt) this.doubt.textContent = doubt;
  }

  /** Return the choice of numbers that are fitted instead of a model. */
  private numbers(names: string[]): HTMLElement {
    const place = element("details", "");
    const boxes = element("div", "tools");
    boxes.append(...names.map((name) => {
      const label = element("label", "");
      const box = Object.assign(element("input", ""), { type: "checkbox" });
      box.setAttribute("aria-label", `Fit ${name}`);
      box.addEventListener("change", () => {
        if (box.checked) this.fitted.add(name);
        else this.fitted.delete(name);
        this.show();
      });
      label.append(box, ` ${name}`);
      return label;
    }));
    place.append(element("summary", "", "Or fit numbers of the plant"), boxes);
    return place;
  }
}

/** Return a word of a command as a shell takes it. */
const quoted = (word: string): string => (/^[\w./:#-]+$/.test(word) ? word : `"${word.replace(/["$`\\]/g, "\\$&")}"`);

function choice(words: string, options: string[]): [HTMLSelectElement, HTMLLabelElement] {
  const [label, select] = [element("label", "", words), element("select", "")];
  select.append(...options.map((each) => element("option", "", each)));
  label.append(select);
  return [select, label];
}
