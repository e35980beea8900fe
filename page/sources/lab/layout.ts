/** Where the log stands: below the shorter of plant and faceplates, that neither leaves a hole. */

/** As in layout.css: from here on plant and faceplates stand side by side. */
const BESIDE = "(min-width: 64rem)";

export function levelled(log: HTMLElement, plant: HTMLElement, faceplates: HTMLElement): void {
  const wide = matchMedia(BESIDE);
  const [left, right] = [plant, faceplates].map((each) => each.parentElement!) as [HTMLElement, HTMLElement];
  const height = (side: HTMLElement): number =>
    ([...side.children] as HTMLElement[]).reduce((sum, each) => sum + (each === log ? 0 : each.offsetHeight), 0);
  const place = (): void => {
    const side = wide.matches && height(left) < height(right) ? left : right;
    // Who reads in it keeps the place.
    if (log.parentElement !== side && !log.contains(document.activeElement)) side.append(log);
  };
  const watch = new ResizeObserver(place);
  watch.observe(plant);
  watch.observe(faceplates);
}
