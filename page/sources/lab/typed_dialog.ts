/** PI and PID loops that a reader types: which pairs, in which form, with which settings. */

import { type Bench, lawParameters } from "./brought.ts";
import { Dialog, selectOf } from "./dialog.ts";
import { element } from "./faceplates.ts";
import type { Form, TypedLaw } from "./laws_data.ts";
import { type LoopMargins, loopMargins } from "./loop_margins.ts";
import { marginsTold } from "./margins_told.ts";
import { pastedSettings, typedLoop, type TypedTexts, WrongLoop } from "./typed_numbers.ts";
import { LinearLoops, type TypedLoop, valuesOf } from "./typed_loops.ts";

const FORMS: [Form, string][] = [
  ["isa", "ideal (ISA): K (1 + 1/(Ti s) + Td s)"],
  ["series", "series: K (1 + 1/(Ti s)) (1 + Td s)"],
  ["parallel", "parallel: K + Ki/s + Kd s"],
];
const BY_HAND = "by hand";
const LABELS: Record<Form, [keyof TypedTexts, string, string][]> = {
  isa: [["gain", "K", ""], ["integral", "Ti", "s"], ["derivative", "Td", "s"], ["weight", "b", ""], ["filter", "N", ""]],
  series: [["gain", "K", ""], ["integral", "Ti", "s"], ["derivative", "Td", "s"], ["weight", "b", ""], ["filter", "N", ""]],
  parallel: [["gain", "K", ""], ["integral", "Ki", "1/s"], ["derivative", "Kd", "s"], ["weight", "b", ""], ["filter", "Tf", "s"]],
};
const HINT = "Settings that were copied from a report can be pasted here. Without Ti (or Ki) there is no integral action, without Td (or Kd) no derivative. b is the share of the setpoint in the proportional part, 1 if left out; the derivative is filtered with Td/N, N = 10, or Tf. An input that has to fall where its measurement falls has a gain below zero.";

interface Row {
  name: string;
  input: HTMLSelectElement;
  fields: Map<keyof TypedTexts, HTMLInputElement>;
  labels: Map<keyof TypedTexts, HTMLElement>;
}

interface Found {
  law: TypedLaw;
  loops: (TypedLoop | null)[];
  moves: string[];
  margins: LoopMargins | null;
}

export class TypedDialog {
  private readonly bench: Bench;
  private readonly laws: TypedLaw[];
  private readonly dialog = new Dialog();
  private readonly form: HTMLSelectElement;
  private readonly units = element("select", "");
  private readonly rows: Row[];
  private readonly told = element("div", "told-law");
  private readonly on: HTMLButtonElement;
  private readonly linear = new Map<TypedLaw, LinearLoops>();
  private found: Found | null = null;

  constructor(bench: Bench) {
    this.bench = bench;
    this.laws = bench.laws.free.filter((each) => each.kind === "pid");
    const form = selectOf("Form", FORMS.map(([, words]) => words));
    this.form = form.select;
    this.form.addEventListener("change", () => (this.label(), this.answer()));
    const units = element("label", "", "Its gains are in ");
    this.units.append(...["choose…", ...this.unitWords()].map((each) => element("option", "", each)));
    units.append(this.units);
    this.units.addEventListener("change", () => this.answer());
    const [first, second] = [element("p", "asked"), element("p", "asked")];
    first.append(form.label);
    second.append(units);
    const first_law = this.laws[0];
    this.rows = bench.data.controlled.map((name) => this.row(name, first_law?.pairs.find(({ output }) => output === name)?.input));
    this.told.setAttribute("aria-live", "polite");
    this.dialog.body.append(first, second, this.table(), element("p", "note", HINT), this.told);
    this.on = this.dialog.button("Switch on without a bump", () => this.switchOn());
    this.dialog.button("Cancel", () => this.dialog.close());
    this.label();
    this.dialog.place.addEventListener("paste", (event) => {
      if (this.paste(event.clipboardData?.getData("text/plain") ?? "")) event.preventDefault();
    });
  }

  open(): void {
    this.answer();
    this.dialog.show("PI or PID control");
  }

  /** Whether there is a law for typed loops. */
  get isThere(): boolean {
    return this.laws.length > 0;
  }

  private unitWords(): string[] {
    const { signals, data } = this.bench;
    const units = [data.inputs, data.controlled].map((names) => [...new Set(names.map((name) => signals.get(name)!.unit || "1"))]);
    const [above, below] = units.map(([unit]) => (unit!.includes("/") ? `(${unit})` : unit!));
    const isOne = units.every(({ length }) => length === 1);
    const percent = this.hasPercent() ? ["%/%, of the ranges"] : [];
    if (isOne && above === "%" && below === "%") return percent.length ? percent : ["%/%, as shown here"];
    return [isOne ? `${above}/${below}, as shown here` : "the units of each pair, as shown here", ...percent];
  }

  private hasPercent(): boolean {
    const { laws, data } = this.bench;
    return [...data.inputs, ...data.controlled].every((name) => laws.percent[name] !== undefined);
  }

  private row(name: string, suggested: string | undefined): Row {
    const { inputs } = this.bench.data;
    const { select } = selectOf("", [...inputs, BY_HAND], suggested === undefined ? inputs.length : inputs.indexOf(suggested));
    select.setAttribute("aria-label", `What ${name} is controlled by`);
    select.addEventListener("change", () => this.answer());
    const [fields, labels] = [new Map<keyof TypedTexts, HTMLInputElement>(), new Map<keyof TypedTexts, HTMLElement>()];
    for (const [part] of LABELS.isa) {
      const field = Object.assign(element("input", ""), { type: "text", inputMode: "decimal", size: 6, autocomplete: "off" });
      field.addEventListener("input", () => this.answer());
      fields.set(part, field);
    }
    return { name, input: select, fields, labels };
  }

  private table(): HTMLElement {
    const list = element("div", "typed-loops");
    for (const row of this.rows) {
      const line = element("div", "typed-loop");
      const by = element("span", "pair", `${row.name} by `);
      by.append(row.input);
      line.append(by);
      for (const [part, field] of row.fields) {
        const label = element("label", "");
        const words = element("span", "");
        row.labels.set(part, words);
        label.append(words, field);
        line.append(label);
      }
      list.append(line);
    }
    return list;
  }

  private get chosenForm(): Form {
    return FORMS[this.form.selectedIndex]![0];
  }

  private label(): void {
    for (const row of this.rows)
      for (const [part, symbol, unit] of LABELS[this.chosenForm]) {
        row.labels.get(part)!.textContent = unit ? `${symbol} [${unit}] ` : `${symbol} `;
        row.fields.get(part)!.setAttribute("aria-label", `${symbol} of ${row.name}${unit ? `, ${unit}` : ""}`);
      }
  }

  /** Fill in the settings of a pasted text; their unit is the one that it says, or is still asked. */
  private paste(text: string): boolean {
    let isAny = false;
    for (const { loop, symbol, value, unit } of pastedSettings(text)) {
      const [part] = LABELS[this.chosenForm].find(([, each]) => each === symbol) ?? [];
      const field = part && this.rows.find(({ name }) => name === loop)?.fields.get(part);
      if (!field) continue;
      field.value = value;
      isAny = true;
      const said = [...this.units.options].findIndex(({ text }) => text.split(",")[0] === unit);
      if (part === "gain") this.units.selectedIndex = Math.max(0, said);
    }
    if (isAny) this.answer();
    return isAny;
  }

  private answer(): void {
    const found = this.computed();
    this.found = typeof found === "string" ? null : found;
    this.told.replaceChildren(
      ...(typeof found === "string" ? [element("p", "note", found)] : marginsTold(found.margins, "the units, the signs and the pairs")),
    );
    this.on.disabled = !this.found;
    this.on.textContent = this.found?.law.controller === this.bench.leading() ? "Take these settings" : "Switch on without a bump";
  }

  /** Return what the answers make, or what is still missing or wrong. */
  private computed(): Found | string {
    const { bench, rows } = this;
    const { data } = bench;
    const form = this.chosenForm;
    rows.forEach((row) => this.mark(row, []));
    const closed = rows.filter((row) => row.input.selectedIndex < data.inputs.length);
    if (!closed.length) return "Choose an input for at least one signal.";
    const moves = closed.map((row) => data.inputs[row.input.selectedIndex]!);
    if (new Set(moves).size < moves.length) return "Two loops cannot move one input: choose another, or leave one by hand.";
    if (!this.units.selectedIndex) return "Say in which unit the gains are. Margins appear here.";
    const law = this.laws.find((each) =>
      each.form === form && closed.every(({ name }, place) => each.pairs.some(({ output, input }) => output === name && input === moves[place])));
    if (!law) return "This page cannot run these pairs: choose others, or give such a controller to clepsydra lab.";
    const loops: (TypedLoop | null)[] = law.pairs.map(() => null);
    for (const [place, row] of closed.entries()) {
      const scale = this.gainScale(moves[place]!, row.name);
      const texts = Object.fromEntries([...row.fields].map(([part, field]) => [part, field.value])) as unknown as TypedTexts;
      const loop = typedLoop(row.name, texts, form, scale);
      if (loop instanceof WrongLoop) {
        this.mark(row, loop.parts);
        return loop.words;
      }
      loops[law.pairs.findIndex(({ output }) => output === row.name)] = loop;
    }
    return { law, loops, moves, margins: this.margins(law, loops, closed.map(({ name }) => name), moves) };
  }

  /** Mark those fields of a loop that are wrong. */
  private mark({ fields }: Row, parts: (keyof TypedTexts)[]): void {
    for (const [part, field] of fields) field.setAttribute("aria-invalid", String(parts.includes(part)));
  }

  private margins(law: TypedLaw, loops: (TypedLoop | null)[], measured: string[], moves: string[]): LoopMargins | null {
    const { bench } = this;
    const plant = bench.plants[law.plant ?? -1];
    const before = this.before(law);
    const linear = this.linear.get(law) ?? new LinearLoops(law, before, bench.modules);
    this.linear.set(law, linear);
    const found = plant && linear.at(valuesOf(law, before, loops, bench.data.period));
    return found && plant ? loopMargins(plant, found, new Set([...measured, ...moves]), bench.data.period) : null;
  }

  private before(law: TypedLaw): number[] {
    return lawParameters(this.bench.data, law.controller).map(([, value]) => value);
  }

  /** Return what a gain of one is in SI. */
  private gainScale(input: string, output: string): number {
    const { signals, laws } = this.bench;
    const isPercent = this.units.selectedIndex === this.units.options.length - 1 && this.hasPercent();
    const scale = (name: string): number => (isPercent ? laws.percent[name]! : 1 / signals.get(name)!.factor);
    return scale(input) / scale(output);
  }

  private switchOn(): void {
    const { law, loops, moves } = this.found!;
    const { bench } = this;
    const values = valuesOf(law, this.before(law), loops, bench.data.period);
    const parameters = lawParameters(bench.data, law.controller);
    const places = law.pairs.flatMap((pair) => Object.values(pair.places));
    const hasDerivative = loops.some((loop) => loop && loop.derivative !== 0);
    const pairs = law.pairs.filter((_, place) => loops[place]).map(({ output, input }) => `${output} by ${input}`);
    this.dialog.close();
    bench.switchOn({
      law,
      title: `${hasDerivative ? "PID" : "PI"} typed in`,
      words: `${pairs.join(", ")}; ${law.form === "isa" ? "ideal" : law.form} form`,
      settings: Object.fromEntries(places.map((place) => [parameters[place]![0], values[place]!])),
      moves,
      start: "bumpless",
      again: () => this.open(),
    });
  }
}
