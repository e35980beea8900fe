/** Which controllers are shown, and in which colour: one choice for all pictures of the page. */

const COLOURS = 8;

export class Shown {
  private readonly places = new Map<number, number>();
  private readonly listeners: (() => void)[] = [];

  constructor(first: number[]) {
    for (const controller of first) this.take(controller);
  }

  /** Return the controllers in the order of their colours. */
  get controllers(): number[] {
    return [...this.places].sort((a, b) => a[1] - b[1]).map(([controller]) => controller);
  }

  has(controller: number): boolean {
    return this.places.has(controller);
  }

  toggle(controller: number): void {
    if (!this.places.delete(controller)) this.take(controller);
    this.tell();
  }

  /** Let all pictures show anew what is shown, as after another name. */
  tell(): void {
    for (const listener of this.listeners) listener();
  }

  /** Show a controller, or take it away. */
  set(controller: number, wanted: boolean): void {
    if (this.has(controller) !== wanted) this.toggle(controller);
  }

  onChange(listener: () => void): void {
    this.listeners.push(listener);
  }

  /** Return the style property that holds the colour of a controller. */
  property(controller: number): string {
    return `--curve-${(this.places.get(controller) ?? 0) % COLOURS}`;
  }

  /** Return how its line is broken, where colours are used for a second time. */
  dash(controller: number): number[] {
    const turn = Math.floor((this.places.get(controller) ?? 0) / COLOURS);
    return turn ? [6 * turn, 3] : [];
  }

  /** Let a swatch of an element look like the line of a controller. */
  paint({ style }: HTMLElement, controller: number): void {
    style.setProperty("--own", `var(${this.property(controller)})`);
    const [length] = this.dash(controller);
    style.setProperty("--dash", length === undefined ? "100%" : `${length}px`);
  }

  private take(controller: number): void {
    const taken = new Set(this.places.values());
    let place = 0;
    while (taken.has(place)) place += 1;
    this.places.set(controller, place);
  }
}

/** Return the value of a style property, a colour of the page. */
export function colour(property: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(property).trim();
}
