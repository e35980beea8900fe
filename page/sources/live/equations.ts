/** Systems of real equations. */

import { at, filled, type Matrix, matrix } from "./matrices.ts";

export function identity(size: number): Matrix {
  return filled(size, size, (row, column) => (row === column ? 1 : 0));
}

export function transposed(of: Matrix): Matrix {
  return filled(of.columns, of.rows, (row, column) => at(of, column, row));
}

export function scaled(of: Matrix, factor: number): Matrix {
  return matrix(of.rows, of.columns, of.values.map((value) => factor * value));
}

/** Return X of M X = R, by elimination with the largest pivots; null where M is singular. */
export function solved(m: Matrix, r: Matrix): Matrix | null {
  const [n, k] = [m.rows, r.columns];
  const [left, right] = [m.values.slice(), r.values.slice()];
  for (let pivot = 0; pivot < n; ++pivot) {
    let largest = pivot;
    for (let row = pivot + 1; row < n; ++row)
      if (Math.abs(left[row * n + pivot]!) > Math.abs(left[largest * n + pivot]!)) largest = row;
    const top = left[largest * n + pivot]!;
    if (top === 0 || !Number.isFinite(top)) return null;
    if (largest !== pivot) {
      swap(left, pivot * n, largest * n, n);
      swap(right, pivot * k, largest * k, k);
    }
    for (let row = pivot + 1; row < n; ++row) {
      const share = left[row * n + pivot]! / top;
      if (share === 0) continue;
      for (let column = pivot; column < n; ++column) left[row * n + column]! -= share * left[pivot * n + column]!;
      for (let column = 0; column < k; ++column) right[row * k + column]! -= share * right[pivot * k + column]!;
    }
  }
  for (let row = n - 1; row >= 0; --row)
    for (let column = 0; column < k; ++column) {
      let rest = right[row * k + column]!;
      for (let known = row + 1; known < n; ++known) rest -= left[row * n + known]! * right[known * k + column]!;
      right[row * k + column] = rest / left[row * n + row]!;
    }
  return matrix(n, k, right);
}

function swap(values: Float64Array, one: number, other: number, count: number): void {
  for (let place = 0; place < count; ++place)
    [values[one + place], values[other + place]] = [values[other + place]!, values[one + place]!];
}
