/** A given regulator as the law of matrices that a page carries: `designs/regulator.py` and `conditioning.py`. */

import { identity, scaled, solved, transposed } from "../live/equations.ts";
import { at, filled, type Matrix, matrix, product, sum } from "../live/matrices.ts";
import type { SampledSystem } from "../live/response.ts";
import { Refused } from "./refused.ts";
import type { GivenRegulator } from "./regulator_file.ts";
import { observerCost, observerGain } from "./riccati.ts";

/** z⁺ = A z + B e + M (u − u°), u = u° + C z + D e with e = y − r. */
export interface ConditionedMatrices {
  transition: Matrix;
  entered: Matrix;
  told: Matrix;
  shown: Matrix;
  direct: Matrix;
}

/** Return a regulator at the sampling period [s] of the process, in its own units and signs. */
export function sampledAt(period: number, { name, A, B, C, D, period: own }: GivenRegulator): SampledSystem {
  if (own !== null) {
    if (Math.abs(own - period) <= 1e-9 * Math.max(own, period)) return { A, B, C, D };
    const remedy = "save it in continuous time, without Ts, or make the laboratory of a process with that sampling_period";
    throw new Refused(`${name}, Ts`, `${own} s`, `${period} s, the sampling period here`, remedy);
  }
  return byTustinsRule({ A, B, C, D }, period) ?? atThePole(name, period);
}

function atThePole(name: string, period: number): never {
  throw new Refused(`${name}, A`, `a pole at ${2 / period} 1/s`, "no pole at 2/T", "sample faster, or save a regulator that is sampled already");
}

/** Return a continuous system as it is sampled by s = 2/T (z − 1)/(z + 1); null where it has a pole at 2/T. */
export function byTustinsRule({ A, B, C, D }: SampledSystem, period: number): SampledSystem | null {
  const half = scaled(A, period / 2);
  const before = sum(identity(A.rows), scaled(half, -1));
  const [held, moved] = [solved(before, sum(identity(A.rows), half)), solved(before, scaled(B, period))];
  const shown = solved(transposed(before), transposed(C));
  if (!held || !moved || !shown || ![held, moved, shown].every(({ values }) => values.every((each) => Math.abs(each) < 1e12))) return null;
  return { A: held, B: moved, C: transposed(shown), D: sum(D, scaled(product(C, moved), 0.5)) };
}

/**
 * Return a regulator in SI, from y − r to u − u°.
 *
 * `inputs` and `outputs` are what one of its units is in SI; `sign` is 1 where it acts on y − r, and −1 on r − y.
 */
export function inSi({ A, B, C, D }: SampledSystem, inputs: number[], outputs: number[], sign: 1 | -1): SampledSystem {
  return {
    A,
    B: filled(B.rows, B.columns, (row, column) => (sign * at(B, row, column)) / inputs[column]!),
    C: filled(C.rows, C.columns, (row, column) => outputs[row]! * at(C, row, column)),
    D: filled(D.rows, D.columns, (row, column) => (sign * outputs[row]! * at(D, row, column)) / inputs[column]!),
  };
}

/**
 * Return it told what was applied, by the observer of its own normalised coprime factors.
 *
 * Null where a mode that does not die out is not reached by an error or not shown by an output. Errors count
 * in these sizes, and outputs that no error moves at once in these.
 */
export function toldByOwnObserver({ A, B, C, D }: SampledSystem, errors: ArrayLike<number>, outputs: ArrayLike<number>): ConditionedMatrices | null {
  const size = Array.from({ length: D.rows }, (_, row) => {
    let found = 0;
    for (let column = 0; column < D.columns; ++column) found += Math.abs(at(D, row, column)) * errors[column]!;
    return found > 0 ? found : outputs[row]!;
  });
  const entering = filled(B.rows, B.columns, (row, column) => at(B, row, column) * errors[column]!);
  const shown = filled(C.rows, C.columns, (row, column) => at(C, row, column) / size[row]!);
  const cost = observerCost(A, entering, shown);
  const gain = cost && observerGain(A, shown, cost);
  // What no error reaches is found from the other side.
  if (!gain || !observerCost(transposed(A), transposed(shown), transposed(entering))) return null;
  const told = filled(gain.rows, gain.columns, (row, column) => at(gain, row, column) / size[column]!);
  return {
    transition: sum(A, scaled(product(told, C), -1)),
    entered: sum(B, scaled(product(told, D), -1)),
    told,
    shown: C,
    direct: D,
  };
}

/** Return it told nothing: it winds up in saturation. */
export function unconditioned({ A, B, C, D }: SampledSystem): ConditionedMatrices {
  return { transition: A, entered: B, told: matrix(A.rows, C.rows), shown: C, direct: D };
}

/** Return a system between all signals of which its own are these, in their order; the others are not joined. */
export function widened({ A, B, C, D }: SampledSystem, inputs: number[], outputs: number[], all: { inputs: number; outputs: number }): SampledSystem {
  const column = (of: Matrix, row: number, input: number): number => {
    const own = inputs.indexOf(input);
    return own < 0 ? 0 : at(of, row, own);
  };
  return {
    A,
    B: filled(A.rows, all.inputs, (row, input) => column(B, row, input)),
    C: filled(all.outputs, A.rows, (output, each) => (outputs.includes(output) ? at(C, outputs.indexOf(output), each) : 0)),
    D: filled(all.outputs, all.inputs, (output, input) => (outputs.includes(output) ? column(D, outputs.indexOf(output), input) : 0)),
  };
}
