/**
 * A system in Hessenberg form, in which its eigenvalues and responses are soon found.
 *
 * It is balanced first (B. N. Parlett and C. Reinsch, Balancing a matrix for calculation of
 * eigenvalues and eigenvectors, Numer. Math. 13, 1969, pages 293–304): what a permutation makes
 * triangular, such as the registers of a dead time, then has its eigenvalues without rounding.
 */

import { at, type Matrix, matrix } from "./matrices.ts";

/** A in Hessenberg form, with B and C in its coordinates: C (zI − A)⁻¹ B stays what it is. */
export interface Hessenberg {
  A: Matrix;
  B: Matrix;
  C: Matrix;
}

/** Balance A and bring it to upper Hessenberg form by reflections, and B and C with it. */
export function hessenberg(A: Matrix, B: Matrix, C: Matrix): Hessenberg {
  const n = A.rows;
  const copied = [A, B, C].map((each) => matrix(each.rows, each.columns, each.values.slice()));
  const [a, b, c] = copied as [Matrix, Matrix, Matrix];
  const [low, high] = balance(a, b, c);
  for (let k = low; k < high - 1; ++k) {
    const vector = Float64Array.from({ length: n }, (_, row) => (row > k && row <= high ? at(a, row, k) : 0));
    if (!vector.some((value, row) => row > k + 1 && value !== 0)) continue;
    const scale = Math.max(...vector.map(Math.abs));
    for (let row = k + 1; row <= high; ++row) vector[row]! /= scale;
    const length = Math.sqrt(vector.reduce((sum, value) => sum + value * value, 0));
    const ahead = vector[k + 1]!;
    vector[k + 1] = ahead + (ahead < 0 ? -length : length);
    const factor = 1 / (length * Math.abs(vector[k + 1]!));
    reflectRows(a, vector, factor, k + 1, high);
    reflectRows(b, vector, factor, k + 1, high);
    reflectColumns(a, vector, factor, k + 1, high);
    reflectColumns(c, vector, factor, k + 1, high);
    for (let row = k + 2; row <= high; ++row) a.values[row * n + k] = 0;
  }
  return { A: a, B: b, C: c };
}

function reflectRows(of: Matrix, vector: Float64Array, factor: number, first: number, last: number): void {
  const { columns, values } = of;
  const shares = new Float64Array(columns);
  for (let row = first; row <= last; ++row) {
    for (let column = 0; column < columns; ++column) {
      shares[column]! += vector[row]! * values[row * columns + column]!;
    }
  }
  for (let row = first; row <= last; ++row) {
    const along = factor * vector[row]!;
    for (let column = 0; column < columns; ++column) values[row * columns + column]! -= along * shares[column]!;
  }
}

function reflectColumns(of: Matrix, vector: Float64Array, factor: number, first: number, last: number): void {
  const { rows, columns, values } = of;
  for (let row = 0; row < rows; ++row) {
    let share = 0;
    for (let column = first; column <= last; ++column) share += values[row * columns + column]! * vector[column]!;
    share *= factor;
    for (let column = first; column <= last; ++column) values[row * columns + column]! -= share * vector[column]!;
  }
}

/** Permute A and scale it by powers of two; outside of what is returned it is triangular. */
function balance(A: Matrix, B: Matrix, C: Matrix): [low: number, high: number] {
  const n = A.rows;
  const a = A.values;
  let [low, high] = [0, n - 1];
  const exchange = (one: number, other: number): void => {
    if (one === other) return;
    for (const each of [A, B]) swapRows(each, one, other);
    for (const each of [A, C]) swapColumns(each, one, other);
  };
  /** Whether a row, or a column, has no entry between low and high but its diagonal. */
  const isAlone = (line: number, asRow: boolean): boolean => {
    for (let place = low; place <= high; ++place) {
      if (place !== line && a[asRow ? line * n + place : place * n + line] !== 0) return false;
    }
    return true;
  };
  const alone = (asRow: boolean): number => {
    for (let line = high; line >= low; --line) if (isAlone(line, asRow)) return line;
    return -1;
  };
  for (let line = alone(true); line >= 0 && high > low; line = alone(true)) exchange(line, high--);
  for (let line = alone(false); line >= 0 && high > low; line = alone(false)) exchange(line, low++);
  for (let settled = false; !settled; ) {
    settled = true;
    for (let line = low; line <= high; ++line) {
      let [column, row] = [0, 0];
      for (let place = low; place <= high; ++place) {
        if (place === line) continue;
        column += Math.abs(a[place * n + line]!);
        row += Math.abs(a[line * n + place]!);
      }
      if (column === 0 || row === 0) continue;
      const factor = 2 ** Math.round(Math.log2(row / column) / 2);
      if (column * factor + row / factor >= 0.95 * (column + row)) continue;
      settled = false;
      for (const each of [A, B]) scaleRow(each, line, 1 / factor);
      for (const each of [A, C]) scaleColumn(each, line, factor);
    }
  }
  return [low, high];
}

function swapRows({ columns, values }: Matrix, one: number, other: number): void {
  const kept = values.slice(one * columns, (one + 1) * columns);
  values.copyWithin(one * columns, other * columns, (other + 1) * columns);
  values.set(kept, other * columns);
}

function swapColumns({ columns, values }: Matrix, one: number, other: number): void {
  for (let row = 0; row < values.length; row += columns) {
    [values[row + one], values[row + other]] = [values[row + other]!, values[row + one]!];
  }
}

function scaleRow({ columns, values }: Matrix, row: number, factor: number): void {
  for (let place = row * columns; place < (row + 1) * columns; ++place) values[place]! *= factor;
}

function scaleColumn({ columns, values }: Matrix, column: number, factor: number): void {
  for (let place = column; place < values.length; place += columns) values[place]! *= factor;
}
