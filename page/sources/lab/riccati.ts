/** The discrete algebraic Riccati equation of an observer, by structured doubling. */

import { identity, scaled, solved, transposed } from "../live/equations.ts";
import { eigenvalues } from "../live/eigenvalues.ts";
import { type Matrix, matrix, product, sum } from "../live/matrices.ts";

/** Each doubles the horizon: 2⁶⁰ samples. */
const MOST_DOUBLINGS = 60;
/** What still changes by less than this share has come to rest. */
const RESTED = 1e-15;
const REFINEMENTS = 2;
/** A solution with a larger residual, as a share of its largest term, is none. */
const LARGEST_RESIDUAL = 1e-9;

/**
 * Return the stabilising Z = A Z Aᵀ + B Bᵀ − A Z Cᵀ (1 + C Z Cᵀ)⁻¹ C Z Aᵀ; null where there is none.
 *
 * Of F = Aᵀ, G = Cᵀ C and H = B Bᵀ: E. K.-W. Chu, H.-Y. Fan, W.-W. Lin and C.-S. Wang, Structure-preserving
 * algorithms for periodic discrete-time algebraic Riccati equations, International Journal of Control 77(8),
 * 2004, 767-788. Newton's steps then take what rounding has left, as `designs/states/riccati.py` has them.
 */
export function observerCost(A: Matrix, B: Matrix, C: Matrix): Matrix | null {
  const weight = product(B, transposed(B));
  let [F, G, H] = [transposed(A), product(transposed(C), C), weight];
  for (let doubling = 0; ; ++doubling) {
    if (doubling === MOST_DOUBLINGS) return null;
    const between = sum(identity(A.rows), product(G, H));
    const [moved, gained] = [solved(between, F), solved(between, G)];
    if (!moved || !gained) return null;
    const change = product(transposed(F), product(H, moved));
    G = symmetric(sum(G, product(product(F, gained), transposed(F))));
    H = symmetric(sum(H, change));
    F = product(F, moved);
    if (!H.values.every(Number.isFinite) || !G.values.every(Number.isFinite)) return null;
    if (largest(change) <= RESTED * largest(H)) break;
  }
  for (let step = 0; step < REFINEMENTS; ++step) {
    const gain = observerGain(A, C, H);
    const closed = gain && sum(A, scaled(product(gain, C), -1));
    if (!gain || !closed || !isStable(closed)) return null;
    // Kleinman: δ − closed δ closedᵀ is what is left of the equation in the form of Joseph.
    const rest = [
      product(product(closed, H), transposed(closed)), weight, product(gain, transposed(gain)), scaled(H, -1),
    ].reduce(sum);
    H = symmetric(sum(H, summed(closed, rest)));
  }
  return residual(A, C, weight, H) <= LARGEST_RESIDUAL ? H : null;
}

/** Return L = A Z Cᵀ (1 + C Z Cᵀ)⁻¹, with which the observer is x̂⁺ = A x̂ + L (y − C x̂). */
export function observerGain(A: Matrix, C: Matrix, Z: Matrix): Matrix | null {
  const spread = sum(identity(C.rows), product(product(C, Z), transposed(C)));
  const found = solved(spread, product(product(C, Z), transposed(A)));
  return found && transposed(found);
}

function isStable(closed: Matrix): boolean {
  return eigenvalues(closed).every(({ real, imaginary }) => Math.hypot(real, imaginary) < 1);
}

/** Return the sum of Aᵏ M (Aᵀ)ᵏ over all k, twice as many terms in each step. */
function summed(closed: Matrix, rest: Matrix): Matrix {
  let [total, power] = [rest, closed];
  while (largest(power) > Number.EPSILON) {
    total = sum(total, product(product(power, total), transposed(power)));
    power = product(power, power);
  }
  return total;
}

function residual(A: Matrix, C: Matrix, weight: Matrix, Z: Matrix): number {
  const gain = observerGain(A, C, Z);
  if (!gain) return Infinity;
  const kept = product(product(A, Z), transposed(A));
  const told = product(product(gain, product(C, Z)), transposed(A));
  const terms = [kept, weight, scaled(told, -1), scaled(Z, -1)];
  return largest(terms.reduce(sum)) / Math.max(...terms.map(largest), Number.MIN_VALUE);
}

function symmetric(of: Matrix): Matrix {
  const other = transposed(of);
  return matrix(of.rows, of.columns, of.values.map((value, place) => (value + other.values[place]!) / 2));
}

function largest(of: Matrix): number {
  return of.values.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
}
