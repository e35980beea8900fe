/** Complex matrices, and systems of equations of them. */

/** Complex numbers, row by row. */
export interface Complex {
  readonly rows: number;
  readonly columns: number;
  readonly real: Float64Array;
  readonly imaginary: Float64Array;
}

export function complex(rows: number, columns: number): Complex {
  const count = rows * columns;
  return { rows, columns, real: new Float64Array(count), imaginary: new Float64Array(count) };
}

/** Return I − left · right. */
export function returnDifference(left: Complex, right: Complex): Complex {
  const found = complex(left.rows, right.columns);
  for (let row = 0; row < found.rows; ++row) {
    for (let column = 0; column < found.columns; ++column) {
      let real = row === column ? 1 : 0;
      let imaginary = 0;
      for (let inner = 0; inner < left.columns; ++inner) {
        const [one, other] = [row * left.columns + inner, inner * right.columns + column];
        const [a, b] = [left.real[one]!, left.imaginary[one]!];
        const [c, d] = [right.real[other]!, right.imaginary[other]!];
        real -= a * c - b * d;
        imaginary -= a * d + b * c;
      }
      found.real[row * found.columns + column] = real;
      found.imaginary[row * found.columns + column] = imaginary;
    }
  }
  return found;
}

/**
 * Solve M X = R by elimination with the largest pivots, in the place of both.
 *
 * Below the diagonal M has entries in so many rows at most: one makes it upper Hessenberg.
 */
export function solve(m: Complex, r: Complex, below = m.rows): void {
  const { rows: n, real: a, imaginary: b } = m;
  const { columns: k, real: x, imaginary: y } = r;
  for (let pivot = 0; pivot < n; ++pivot) {
    const last = Math.min(pivot + below, n - 1);
    let largest = pivot;
    for (let row = pivot + 1; row <= last; ++row) {
      if (size(m, row * n + pivot) > size(m, largest * n + pivot)) largest = row;
    }
    if (largest !== pivot) {
      swap(a, b, pivot * n, largest * n, pivot, n);
      swap(x, y, pivot * k, largest * k, 0, k);
    }
    const place = pivot * n + pivot;
    const square = a[place]! ** 2 + b[place]! ** 2;
    for (let row = pivot + 1; row <= last; ++row) {
      const [c, d] = [a[row * n + pivot]!, b[row * n + pivot]!];
      if (c === 0 && d === 0) continue;
      const real = (c * a[place]! + d * b[place]!) / square;
      const imaginary = (d * a[place]! - c * b[place]!) / square;
      subtract(a, b, row * n, pivot * n, pivot + 1, n, real, imaginary);
      subtract(x, y, row * k, pivot * k, 0, k, real, imaginary);
    }
  }
  for (let row = n - 1; row >= 0; --row) {
    for (let known = row + 1; known < n; ++known) {
      subtract(x, y, row * k, known * k, 0, k, a[row * n + known]!, b[row * n + known]!);
    }
    const [c, d] = [a[row * n + row]!, b[row * n + row]!];
    const square = c ** 2 + d ** 2;
    for (let place = row * k; place < (row + 1) * k; ++place) {
      const [real, imaginary] = [x[place]!, y[place]!];
      x[place] = (real * c + imaginary * d) / square;
      y[place] = (imaginary * c - real * d) / square;
    }
  }
}

/** What pivots are compared by: |real| + |imaginary|. */
function size(m: Complex, place: number): number {
  return Math.abs(m.real[place]!) + Math.abs(m.imaginary[place]!);
}

function swap(
  a: Float64Array, b: Float64Array, one: number, other: number, first: number, stop: number,
): void {
  for (let place = first; place < stop; ++place) {
    [a[one + place], a[other + place]] = [a[other + place]!, a[one + place]!];
    [b[one + place], b[other + place]] = [b[other + place]!, b[one + place]!];
  }
}

/** Subtract a multiple of one row from another. */
function subtract(
  a: Float64Array, b: Float64Array, from: number, row: number, first: number, stop: number,
  real: number, imaginary: number,
): void {
  for (let place = first; place < stop; ++place) {
    const [c, d] = [a[row + place]!, b[row + place]!];
    a[from + place]! -= real * c - imaginary * d;
    b[from + place]! -= real * d + imaginary * c;
  }
}
