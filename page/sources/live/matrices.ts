/** Real matrices. */

export interface Matrix {
  readonly rows: number;
  readonly columns: number;
  /** Row by row. */
  readonly values: Float64Array;
}

export function matrix(rows: number, columns: number, values?: Float64Array): Matrix {
  return { rows, columns, values: values ?? new Float64Array(rows * columns) };
}

/** Return the matrix whose entries a function gives. */
export function filled(rows: number, columns: number, at: (row: number, column: number) => number): Matrix {
  const made = matrix(rows, columns);
  for (let row = 0; row < rows; ++row) {
    for (let column = 0; column < columns; ++column) made.values[row * columns + column] = at(row, column);
  }
  return made;
}

export function at(of: Matrix, row: number, column: number): number {
  return of.values[row * of.columns + column]!;
}

export function product(left: Matrix, right: Matrix): Matrix {
  const found = matrix(left.rows, right.columns);
  for (let row = 0; row < left.rows; ++row) {
    for (let inner = 0; inner < left.columns; ++inner) {
      const factor = at(left, row, inner);
      if (factor === 0) continue;
      for (let column = 0; column < right.columns; ++column) {
        found.values[row * right.columns + column]! += factor * at(right, inner, column);
      }
    }
  }
  return found;
}

/** Return the matrix that rows of blocks make, of which those in a row are equally high. */
export function blocks(parts: Matrix[][]): Matrix {
  const heights = parts.map((row) => row[0]!.rows);
  const widths = parts[0]!.map((part) => part.columns);
  const total = (sizes: number[]): number => sizes.reduce((sum, size) => sum + size, 0);
  const whole = matrix(total(heights), total(widths));
  let top = 0;
  parts.forEach((row, place) => {
    let left = 0;
    for (const part of row) {
      for (let line = 0; line < part.rows; ++line) {
        const values = part.values.subarray(line * part.columns, (line + 1) * part.columns);
        whole.values.set(values, (top + line) * whole.columns + left);
      }
      left += part.columns;
    }
    top += heights[place]!;
  });
  return whole;
}

/** Return some rows and columns of a matrix, in this order. */
export function among(of: Matrix, rows: number[], columns: number[]): Matrix {
  return filled(rows.length, columns.length, (row, column) => at(of, rows[row]!, columns[column]!));
}

export function sum(left: Matrix, right: Matrix): Matrix {
  return matrix(left.rows, left.columns, left.values.map((value, place) => value + right.values[place]!));
}
