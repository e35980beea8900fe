/** What a reader got wrong: where it stands, what is there, what was expected, and what to do. */

export class Refused extends Error {
  readonly place: string;
  readonly given: string;
  readonly expected: string;
  readonly remedy: string;

  constructor(place: string, given: string, expected: string, remedy: string) {
    super(`${place}: got ${given}, expected ${expected}; ${remedy}.`);
    [this.place, this.given, this.expected, this.remedy] = [place, given, expected, remedy];
  }
}
