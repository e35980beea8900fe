/**
 * The eigenvalues of a real matrix, by double steps of QR on its Hessenberg form.
 *
 * R. S. Martin, G. Peters and J. H. Wilkinson, The QR algorithm for real Hessenberg matrices, Numer.
 * Math. 14, 1970, pages 219–231, `hqr` of EISPACK.
 */

import { hessenberg } from "./hessenberg.ts";
import { type Matrix, matrix } from "./matrices.ts";

export interface Eigenvalue {
  real: number;
  imaginary: number;
}

/** Turns of one eigenvalue after which a shift out of the ordinary is made, and at most. */
const STALLED = 10;
const MOST = 100;
const EPSILON = Number.EPSILON;

export function eigenvalues(of: Matrix): Eigenvalue[] {
  if (!of.values.every(Number.isFinite)) throw new RangeError("a matrix of finite numbers was expected");
  return byDoubleSteps(hessenberg(of, matrix(of.rows, 0), matrix(0, of.rows)).A);
}

/** Return the eigenvalues of an upper Hessenberg matrix, which is spoilt. */
function byDoubleSteps(of: Matrix): Eigenvalue[] {
  const n = of.rows;
  const h = of.values;
  const found = Array<Eigenvalue>(n);
  const norm = h.reduce((sum, value) => sum + Math.abs(value), 0);
  let shifted = 0;
  let last = n - 1;
  let turns = 0;
  while (last >= 0) {
    const first = startOfBlock(h, n, last, norm);
    const x = h[last * n + last]!;
    if (first === last) {
      found[last--] = { real: x + shifted, imaginary: 0 };
      turns = 0;
      continue;
    }
    const y = h[(last - 1) * n + last - 1]!;
    const w = h[last * n + last - 1]! * h[(last - 1) * n + last]!;
    if (first === last - 1) {
      [found[last - 1], found[last]] = ofPair(x + shifted, (y - x) / 2, w);
      last -= 2;
      turns = 0;
      continue;
    }
    if (++turns > MOST) throw new Error("the eigenvalues of a loop were not found");
    if (turns % STALLED) {
      doubleStep(h, n, first, last, [x, y, w]);
      continue;
    }
    shifted += x;
    for (let place = 0; place <= last; ++place) h[place * n + place]! -= x;
    const size = Math.abs(h[last * n + last - 1]!) + Math.abs(h[(last - 1) * n + last - 2]!);
    doubleStep(h, n, first, last, [0.75 * size, 0.75 * size, -0.4375 * size * size]);
  }
  return found;
}

/** Return where the block that ends here begins: above it a subdiagonal entry is only rounding. */
function startOfBlock(h: Float64Array, n: number, last: number, norm: number): number {
  for (let row = last; row > 0; --row) {
    const beside = Math.abs(h[(row - 1) * n + row - 1]!) + Math.abs(h[row * n + row]!) || norm;
    if (Math.abs(h[row * n + row - 1]!) <= EPSILON * beside) {
      h[row * n + row - 1] = 0;
      return row;
    }
  }
  return 0;
}

/** Return the eigenvalues of a block of two rows: x, half of y − x, and the product beside. */
function ofPair(x: number, half: number, w: number): [Eigenvalue, Eigenvalue] {
  const square = half * half + w;
  const root = Math.sqrt(Math.abs(square));
  if (square < 0) {
    return [
      { real: x + half, imaginary: root },
      { real: x + half, imaginary: -root },
    ];
  }
  const farther = half + (half < 0 ? -root : root);
  const nearer = farther === 0 ? 0 : -w / farther;
  return [
    { real: x + farther, imaginary: 0 },
    { real: x + nearer, imaginary: 0 },
  ];
}

/** Chase a bulge of two shifts, x + y and x y − w, through the block from first to last. */
function doubleStep(
  h: Float64Array, n: number, first: number, last: number, [x, y, w]: [number, number, number],
): void {
  let start = last - 2;
  let bulge: [number, number, number];
  for (; ; --start) {
    const here = start * n + start;
    const z = h[here]!;
    const [r, s] = [x - z, y - z];
    bulge = [
      (r * s - w) / h[here + n]! + h[here + 1]!,
      h[here + n + 1]! - z - r - s,
      h[here + 2 * n + 1]!,
    ];
    const size = Math.abs(bulge[0]) + Math.abs(bulge[1]) + Math.abs(bulge[2]);
    bulge = [bulge[0] / size, bulge[1] / size, bulge[2] / size];
    if (start === first) break;
    const above = Math.abs(h[here - 1]!) * (Math.abs(bulge[1]) + Math.abs(bulge[2]));
    const around = Math.abs(h[here - n - 1]!) + Math.abs(z) + Math.abs(h[here + n + 1]!);
    if (above <= EPSILON * Math.abs(bulge[0]) * around) break;
  }
  for (let row = start + 2; row <= last; ++row) {
    h[row * n + row - 2] = 0;
    if (row > start + 2) h[row * n + row - 3] = 0;
  }
  for (let k = start; k < last; ++k) {
    const three = k < last - 1;
    let [p, q, r] = bulge;
    let scale = 1;
    if (k > start) {
      [p, q, r] = [h[k * n + k - 1]!, h[(k + 1) * n + k - 1]!, three ? h[(k + 2) * n + k - 1]! : 0];
      scale = Math.abs(p) + Math.abs(q) + Math.abs(r);
      if (scale === 0) continue;
      [p, q, r] = [p / scale, q / scale, r / scale];
    }
    const length = Math.hypot(p, q, r);
    const s = p < 0 ? -length : length;
    if (s === 0) continue;
    if (k > start) h[k * n + k - 1] = -s * scale;
    else if (first < start) h[k * n + k - 1] = -h[k * n + k - 1]!;
    p += s;
    const [alongP, alongQ, alongR] = [p / s, q / s, r / s];
    [q, r] = [q / p, r / p];
    for (let column = k; column <= last; ++column) {
      const here = k * n + column;
      let share = h[here]! + q * h[here + n]!;
      if (three) {
        share += r * h[here + 2 * n]!;
        h[here + 2 * n]! -= share * alongR;
      }
      h[here + n]! -= share * alongQ;
      h[here]! -= share * alongP;
    }
    const stop = Math.min(last, k + 3);
    for (let row = first; row <= stop; ++row) {
      const here = row * n + k;
      let share = alongP * h[here]! + alongQ * h[here + 1]!;
      if (three) {
        share += alongR * h[here + 2]!;
        h[here + 2]! -= share * r;
      }
      h[here + 1]! -= share * q;
      h[here]! -= share;
    }
  }
}
