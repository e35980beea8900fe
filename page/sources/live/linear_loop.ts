/** The linear model of a sampled loop, as `designs/sampled/sampled_loop.py` joins it. */

import { type Eigenvalue, eigenvalues } from "./eigenvalues.ts";
import { largestGain } from "./frequency_peak.ts";
import { among, at, blocks, filled, type Matrix, matrix, product, sum } from "./matrices.ts";
import type { SampledPlant, SlopesProgram } from "./messages.ts";
import { Response, type SampledSystem } from "./response.ts";

/** An eigenvalue this near to the unit circle stands on it. */
const ROUNDING = 1e-10;

/** x⁺ = held x + moved u, y = measured x, and what the controller has setpoints for. */
export interface Plant {
  held: Matrix;
  moved: Matrix;
  measured: Matrix;
  controlled: Matrix;
  /** 1 where a measurement is the controlled one of a column. */
  enters: Matrix;
  /** Ranges of what is controlled. */
  sizes: Float64Array;
  response: Response;
}

export function plantOf(
  { states, measurements, manipulated, controlled }: SampledPlant, numbers: Float64Array,
): Plant {
  const [p, m, q] = [measurements.length, manipulated.length, controlled.length];
  let place = 0;
  const next = (rows: number, columns: number): Matrix => {
    const values = numbers.subarray(place, (place += rows * columns));
    return matrix(rows, columns, values);
  };
  const [held, moved, measured] = [next(states, states), next(states, m), next(p, states)];
  return {
    held,
    moved,
    measured,
    controlled: next(q, states),
    enters: next(p, q),
    sizes: next(q, 1).values,
    response: new Response({ A: held, B: moved, C: measured, D: matrix(p, m) }),
  };
}

/**
 * Return a law in automatic from its measurements to its outputs, of the slopes at its values.
 *
 * Its states are those that move and that something depends on; what a delay ring holds counts.
 */
export function lawOf(slopes: SlopesProgram, values: ArrayLike<number>): SampledSystem {
  const { states: n, setpoints, measurements, outputs, entries, longer } = slopes;
  const more = longer.reduce((count, [, length]) => count + length, 0);
  const inputs = setpoints + measurements;
  const stepX = matrix(n + more, n + more);
  const stepU = matrix(n + more, inputs);
  const outputX = matrix(outputs, n + more);
  const outputU = matrix(outputs, inputs);
  const parts = [stepX, stepU, outputX, outputU];
  entries.forEach(([which, row, column], place) => {
    const part = parts[which]!;
    part.values[row * part.columns + column] = values[place]!;
  });
  let first = n;
  for (const [state, length] of longer) {
    for (const { values: numbers, columns } of [stepX, stepU]) {
      // What is written comes in at the end, and the law reads the oldest.
      numbers.copyWithin(first * columns, state * columns, (state + 1) * columns);
      numbers.fill(0, state * columns, (state + 1) * columns);
    }
    for (let each = 0; each < length; ++each) {
      const to = each + 1 < length ? first + each + 1 : state;
      stepX.values[to * stepX.columns + first + each] = 1;
    }
    first += length;
  }
  const modes = Array.from({ length: n + more }, (_, state) => state).filter(
    (state) => isRead(state, stepX, outputX) && isMoved(state, stepX, stepU),
  );
  const every = Array.from({ length: outputs }, (_, output) => output);
  const measured = Array.from({ length: measurements }, (_, input) => setpoints + input);
  return {
    A: among(stepX, modes, modes),
    B: among(stepU, modes, measured),
    C: among(outputX, every, modes),
    D: among(outputU, every, measured),
  };
}

function isRead(state: number, stepX: Matrix, outputX: Matrix): boolean {
  return [stepX, outputX].some((part) => {
    for (let row = 0; row < part.rows; ++row) if (at(part, row, state) !== 0) return true;
    return false;
  });
}

/** Whether something moves a state: what nothing moves is a constant and no mode of the loop. */
function isMoved(state: number, stepX: Matrix, stepU: Matrix): boolean {
  for (let column = 0; column < stepX.columns; ++column) {
    if (at(stepX, state, column) !== (column === state ? 1 : 0)) return true;
  }
  for (let input = 0; input < stepU.columns; ++input) if (at(stepU, state, input) !== 0) return true;
  return false;
}

/** What a loop does by itself. */
export interface Analysis {
  poles: Eigenvalue[];
  stable: boolean;
  /** max|S|; infinite where it is unstable. */
  peak: number;
  /** From each output to itself, in its range; null where it is unstable. */
  sensitivity: SampledSystem | null;
}

/** Return what the loop of a plant and a law does, its output sensitivity above all. */
export function analysisOf(plant: Plant, law: SampledSystem): Analysis {
  const { held, moved, measured, controlled, enters, sizes } = plant;
  const direct = product(moved, law.D);
  const closed = blocks([
    [sum(held, product(direct, measured)), product(moved, law.C)],
    [product(law.B, measured), law.A],
  ]);
  const poles = eigenvalues(closed);
  const stable = poles.every(({ real, imaginary }) => Math.hypot(real, imaginary) < 1 - ROUNDING);
  if (!stable) return { poles, stable, peak: Infinity, sensitivity: null };
  const entering = product(blocks([[direct], [law.B]]), enters);
  const q = sizes.length;
  const sensitivity = {
    A: closed,
    B: filled(closed.rows, q, (row, column) => at(entering, row, column) * sizes[column]!),
    C: filled(q, closed.rows, (row, column) =>
      column < held.rows ? at(controlled, row, column) / sizes[row]! : 0,
    ),
    D: filled(q, q, (row, column) => (row === column ? 1 : 0)),
  };
  return { poles, stable, peak: largestGain(sensitivity, poles), sensitivity };
}
