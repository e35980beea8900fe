/** A regulator in a MAT file, as Matlab and Octave save one: `designs/regulators/mat_file.py` and `given.py`. */

import { filled, type Matrix, matrix } from "../live/matrices.ts";
import { roundedText } from "../words.ts";
import { Damaged, matVariables, type Variable } from "./mat_variables.ts";
import { Refused } from "./refused.ts";

/** x' = A x + B e, u = C x + D e in continuous time, or x(k+1) with a sampling period [s]; in units of its own. */
export interface GivenRegulator {
  /** What the reader calls it: its file. */
  name: string;
  A: Matrix;
  B: Matrix;
  C: Matrix;
  D: Matrix;
  period: number | null;
}

/** As many as the matrices that a page carries have. */
export const MOST_STATES = 12;
const EXPECTED = "a MAT file with the matrices A, B, C and D";
const SAVE = "save it as in [A, B, C, D] = ssdata(F); save('reg1.mat', 'A', 'B', 'C', 'D', '-v7')";
const TOGETHER = "save A, B, C and D of one state space";
const REDUCE = "reduce its order, as with balred, or name it in a study file, regulator = \"reg1.mat\", where up to 60 states fit";
/** Sixty states take 0.1 MB. */
const LARGEST_FILE = 1_000_000;
/** Rows and columns whose numbers are read. */
const MOST_READ = 60;
/** From here on a number is a mistake, or the regulator a limiter. */
const LARGEST_NUMBER = 1e12;
const REQUIRED = ["A", "B", "C", "D"] as const;
const HDF = "\x89HDF\r\n";
const OCTAVES_OWN = [["# Created by Octave", "Octave's text form"], ["Octave-1-", "Octave's binary form"]] as const;

/** Read a regulator from the bytes of a file; refuse what is none, with what to do. */
export async function regulatorOf(name: string, content: Uint8Array): Promise<GivenRegulator> {
  if (content.length > LARGEST_FILE) throw new Refused(name, "more than 1 MB", EXPECTED, "choose the file of the regulator");
  const first = String.fromCharCode(...content.subarray(0, 520));
  if (first.includes(HDF)) throw new Refused(name, "version 7.3, an HDF5 file", `${EXPECTED} of version 7 or lower`, SAVE);
  for (const [beginning, form] of OCTAVES_OWN)
    if (first.startsWith(beginning)) throw new Refused(name, form, EXPECTED, SAVE);
  const found = await variablesOf(name, content);
  const missing = REQUIRED.filter((each) => !found.has(each));
  if (missing.length) {
    const there = [...found.keys()].filter((each) => /^[A-Za-z]\w*$/.test(each)).sort().join(", ").slice(0, 60);
    throw new Refused(name, there || "no variables", `${EXPECTED}; it lacks ${missing.join(", ")}`, SAVE);
  }
  const [A, B, C, given] = REQUIRED.map((each) => numbersOf(name, each, found.get(each)!)) as [Matrix, Matrix, Matrix, Matrix];
  const [states, inputs, outputs] = [A.rows, B.columns, C.rows];
  if (A.rows !== A.columns || states < 1) {
    const remedy = `${TOGETHER}; a regulator without states is a PI or PID controller with Ti left out`;
    throw new Refused(`${name}, A`, sizeText(A), "a square matrix of 1 or more states", remedy);
  }
  if (states > MOST_STATES) throw new Refused(`${name}, A`, sizeText(A), `at most ${MOST_STATES} states`, REDUCE);
  // A single zero is a D of the size that fits.
  const D = given.rows === 1 && given.columns === 1 && given.values[0] === 0 ? matrix(outputs, inputs) : given;
  for (const [called, of, rows, columns] of [["B", B, states, inputs], ["C", C, outputs, states], ["D", D, outputs, inputs]] as const)
    if (of.rows !== rows || of.columns !== columns) {
      const expected = `${rows} × ${columns}, as the others have ${states} states, ${inputs} inputs and ${outputs} outputs`;
      throw new Refused(`${name}, ${called}`, sizeText(of), expected, TOGETHER);
    }
  checkDescriptor(name, states, found.get("E"));
  return { name, A, B, C, D, period: periodOf(name, found.get("Ts")) };
}

async function variablesOf(name: string, content: Uint8Array): Promise<Map<string, Variable>> {
  try {
    return await matVariables(content, MOST_READ);
  } catch (error) {
    if (error instanceof Damaged) throw new Refused(name, "something that is not a MAT file, or is damaged", EXPECTED, SAVE);
    throw error;
  }
}

/** Return a matrix of real finite numbers, row by row; refuse any other. */
function numbersOf(name: string, called: string, { kind, shape, numbers, isComplex }: Variable): Matrix {
  const place = `${name}, ${called}`;
  if (!numbers) {
    const remedy = `${SAVE}, of a regulator of low order; full(${called}) if it is sparse`;
    const expected = `a matrix of numbers, at most ${MOST_STATES} × ${MOST_STATES}`;
    throw new Refused(place, `${kind} ${shape.join(" × ")}`.trim(), expected, remedy);
  }
  const expected = "a matrix of real finite numbers";
  if (isComplex) throw new Refused(place, "complex numbers", expected, `save real(${called}) where the imaginary parts are rounding`);
  const wrong = numbers.find((each) => !(Math.abs(each) <= LARGEST_NUMBER));
  if (wrong !== undefined) throw new Refused(place, roundedText(wrong, 3), `${expected}, none above 1e12`, "look at how the regulator was made");
  const [rows, columns] = shape as [number, number];
  return filled(rows, columns, (row, column) => numbers[column * rows + row]!);
}

/** Refuse a descriptor system, which may be improper; an empty E is the identity. */
function checkDescriptor(name: string, states: number, E: Variable | undefined): void {
  if (!E || E.shape.includes(0)) return;
  const isIdentity =
    !E.isComplex && E.shape[0] === states && E.shape[1] === states &&
    E.numbers?.every((value, place) => value === (place % (states + 1) ? 0 : 1));
  if (isIdentity) return;
  throw new Refused(`${name}, E`, "another matrix", "the identity: a regulator x' = A x + B e", "make it proper and explicit, as with ss(F, 'explicit')");
}

function periodOf(name: string, Ts: Variable | undefined): number | null {
  if (!Ts) return null;
  const value = Ts.numbers?.[0] ?? NaN;
  if (Ts.numbers?.length !== 1 || Ts.isComplex || !(value >= 0 && value < Infinity)) {
    const given = Ts.numbers ? [...Ts.numbers.subarray(0, 3)].join(", ") || "nothing" : Ts.kind;
    throw new Refused(`${name}, Ts`, given, "one number, 0 or above [s]", "give the sampling period, or 0 in continuous time; Matlab's -1 is none");
  }
  return value || null;
}

function sizeText({ rows, columns }: Matrix): string {
  return `${rows} × ${columns}`;
}
