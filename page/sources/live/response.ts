/** Frequency responses of sampled systems: C (zI − A)⁻¹ B + D on the unit circle. */

import { type Complex, complex, solve } from "./complex.ts";
import { hessenberg } from "./hessenberg.ts";
import type { Matrix } from "./matrices.ts";

export interface SampledSystem {
  A: Matrix;
  B: Matrix;
  C: Matrix;
  D: Matrix;
}

/** A point of the complex plane. */
export interface Point {
  real: number;
  imaginary: number;
}

/** A system of which many points are asked for: each then takes n² operations in place of n³. */
export class Response {
  readonly #system: SampledSystem;
  /** zI − A and B before and after elimination, used again at each point. */
  readonly #pencil: Complex;
  readonly #states: Complex;

  constructor({ A, B, C, D }: SampledSystem) {
    this.#system = { ...hessenberg(A, B, C), D };
    this.#pencil = complex(A.rows, A.rows);
    this.#states = complex(A.rows, B.columns);
  }

  at(z: Point): Complex {
    const { A, B, C, D } = this.#system;
    const n = A.rows;
    const [pencil, states] = [this.#pencil, this.#states];
    A.values.forEach((value, place) => (pencil.real[place] = -value));
    pencil.imaginary.fill(0);
    for (let place = 0; place < n * n; place += n + 1) {
      pencil.real[place]! += z.real;
      pencil.imaginary[place] = z.imaginary;
    }
    states.real.set(B.values);
    states.imaginary.fill(0);
    solve(pencil, states, 1);
    const found = complex(C.rows, B.columns);
    found.real.set(D.values);
    for (let row = 0; row < C.rows; ++row) {
      for (let inner = 0; inner < n; ++inner) {
        const share = C.values[row * n + inner]!;
        if (share === 0) continue;
        for (let column = 0; column < B.columns; ++column) {
          found.real[row * B.columns + column]! += share * states.real[inner * B.columns + column]!;
          found.imaginary[row * B.columns + column]! += share * states.imaginary[inner * B.columns + column]!;
        }
      }
    }
    return found;
  }
}
