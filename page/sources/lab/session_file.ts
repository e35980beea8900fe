/** A session that a laboratory saved, read and checked: the page refuses what `clepsydra replay` would. */

import type { LabData, SessionFile, Touch } from "./data.ts";

/** Four months at a sample a second. */
const MOST_SAMPLES = 10_000_000;
/** Of a text in a message. */
const LONGEST = 40;
/** Of what a reader calls a controller. */
const LONGEST_TITLE = 300;
const AGAIN = "save it once more from the laboratory";

/** Why a session cannot run here, and what to do. */
export class Refused extends Error {}

/** Return a session from the text of a file. */
export function readSession(text: string, data: LabData): SessionFile {
  let found: unknown;
  try {
    found = JSON.parse(text);
  } catch {
    throw new Refused("no JSON; choose a session that a laboratory saved");
  }
  return sessionOf(found, data);
}

/** Return a session from values of JSON. */
export function sessionOf(found: unknown, data: LabData): SessionFile {
  if (!isObject(found)) throw new Refused("no session of a laboratory; choose one that a laboratory saved");
  const its = (name: string, wanted: unknown, remedy: string): void => {
    if (JSON.stringify(found[name]) !== JSON.stringify(wanted)) throw refused(name, found[name], `expected ${said(wanted)}`, remedy);
  };
  its("form", data.form, "open it in a laboratory of the version that saved it");
  its("version", data.version, `open it in a laboratory of that version, or make one by it`);
  its("process", data.process, "open the laboratory of that process");
  its("controllers", data.controllers.slice(0, data.laws.given.length).map(({ name }) => name), "open a laboratory with these controllers");
  its("digest", data.digest, "open the laboratory in which it was saved: its process or a controller has another number");
  its("seed", data.seed, AGAIN);
  const { start, samples, touches } = found;
  if (start !== "rest" && start !== "empty") throw refused("start", start, "expected rest or empty");
  if (!isCount(samples) || samples < 1 || samples > MOST_SAMPLES) throw refused("samples", samples, `expected a whole number from 1 to ${MOST_SAMPLES}`);
  if (!Array.isArray(touches)) throw refused("touches", touches, "expected what was done");
  let last = 0;
  const known = knownNames(data);
  touches.forEach((touch: unknown, place) => {
    const where = `touches[${place}]`;
    checkTouch(touch, where, known);
    if (touch.sample < last || touch.sample >= samples)
      throw refused(`${where}.sample`, touch.sample, `expected a sample from ${last}, that of the touch before, to ${samples - 1}`);
    last = touch.sample;
  });
  checkTitles(found.titles, [...known.settings.keys()]);
  return found as unknown as SessionFile;
}

interface Known {
  inputs: string[];
  parameters: string[];
  measurements: string[];
  /** Controller to the parameters of its law. */
  settings: Map<string, string[]>;
}

function knownNames({ controllers, parameters, measurements }: LabData): Known {
  const own = parameters.map(({ name }) => name);
  return {
    inputs: [...new Set(controllers.flatMap(({ inputs }) => inputs.map(([name]) => name)))],
    parameters: own,
    measurements,
    settings: new Map(controllers.map((each) => [each.name, each.parameters.map(([name]) => name).filter((name) => !own.includes(name))])),
  };
}

function checkTouch(touch: unknown, where: string, known: Known): asserts touch is Touch {
  if (!isObject(touch)) throw refused(where, touch, "expected what a hand did");
  if (!isCount(touch.sample)) throw refused(`${where}.sample`, touch.sample, "expected a whole number");
  const one = (field: string, names: string[]): void => {
    if (!names.includes(touch[field] as string)) throw refused(`${where}.${field}`, touch[field], "expected one of this laboratory");
  };
  const numbers = (field: string, names: string[]): void => {
    const values = touch[field];
    if (!isObject(values)) throw refused(`${where}.${field}`, values, "expected numbers by name");
    for (const [name, value] of Object.entries(values)) {
      if (!names.includes(name)) throw refused(`${where}.${field}`, name, "expected one of this laboratory");
      number(`${field}.${name}`, value);
    }
  };
  const number = (field: string, value: unknown): void => {
    if (typeof value !== "number" || !Number.isFinite(value)) throw refused(`${where}.${field}`, value, "expected a finite number, in SI");
  };
  if ("parameters" in touch) numbers("parameters", known.parameters);
  else if ("settings" in touch) {
    one("of", [...known.settings.keys()]);
    numbers("settings", known.settings.get(touch.of as string)!);
  } else if ("controller" in touch) {
    one("controller", [...known.settings.keys()]);
    if (![undefined, "bumpless", "settled", "zero"].includes(touch.start as string)) throw refused(`${where}.start`, touch.start, "expected bumpless, settled or zero");
  } else if ("noise" in touch) {
    if (typeof touch.noise !== "boolean") throw refused(`${where}.noise`, touch.noise, "expected true or false");
  } else if ("drift" in touch) {
    one("drift", known.measurements);
    number("rate", touch.rate);
  } else {
    one("input", known.inputs);
    number("value", touch.value);
  }
}

function checkTitles(titles: unknown, controllers: string[]): void {
  if (titles === undefined) return;
  if (!isObject(titles)) throw refused("titles", titles, "expected texts by controller");
  for (const [name, title] of Object.entries(titles)) {
    if (!controllers.includes(name)) throw refused("titles", name, "expected one of this laboratory");
    if (typeof title !== "string" || title.length > LONGEST_TITLE) throw refused(`titles.${name}`, title, `expected a text of up to ${LONGEST_TITLE} letters`);
  }
}

const isObject = (value: unknown): value is Record<string, unknown> => typeof value === "object" && value !== null && !Array.isArray(value);
const isCount = (value: unknown): value is number => Number.isSafeInteger(value) && (value as number) >= 0;

function refused(place: string, found: unknown, expected: string, remedy = AGAIN): Refused {
  return new Refused(`${place}: got ${said(found)}, ${expected}; ${remedy}`);
}

function said(value: unknown): string {
  const text = JSON.stringify(value) ?? "nothing";
  return text.length > LONGEST ? `${text.slice(0, LONGEST)}…` : text;
}
