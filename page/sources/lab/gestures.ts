/** What fingers, mouse and keys do on a trend, in samples of its run. */

import type uPlot from "uplot";

import type { View } from "./view.ts";

/** A click moves no further; and so near is a cursor that is taken [px]. */
const [STILL, NEAR] = [4, 7];
/** What a turn of the wheel, and a key, zooms by. */
const [WHEEL, KEY] = [1.2, 1.5];
/** Cursors go so far with an arrow, and with Shift [px]; a page pans by a share of what is seen. */
const [ARROW, FAR, PAGE] = [1, 20, 0.5];

export interface Gestures {
  view: View;
  /** Samples in one unit of the chart's axis. */
  scale: () => number;
  /** Where a click is meant: at what is marked nearby. */
  snapped: (sample: number, within: number) => number;
  changed: () => void;
}

/** Let a chart be zoomed, moved and marked; its element takes the keys. */
export function listen(chart: uPlot, element: HTMLElement, gestures: Gestures): void {
  const { view, changed } = gestures;
  const { over } = chart;
  const sampleAt = (left: number): number => chart.posToVal(left, "x") * gestures.scale();
  const leftOf = (sample: number): number => chart.valToPos(sample / gestures.scale(), "x");
  const place = (event: MouseEvent): number => event.clientX - over.getBoundingClientRect().left;
  const perPixel = (): number => view.length / Math.max(1, over.clientWidth);
  const fingers = new Map<number, number>();
  let drag: { kind: "zoom" | "pan" | "cursor"; from: number; to: number; far: boolean } | undefined;

  over.style.touchAction = "pan-y";
  over.addEventListener("pointerdown", (event) => {
    if (event.button > 1) return;
    element.focus({ preventScroll: true });
    over.setPointerCapture(event.pointerId);
    const left = place(event);
    fingers.set(event.pointerId, left);
    const near = view.cursors.findIndex((each) => Math.abs(leftOf(each) - left) < NEAR);
    if (near >= 0) view.active = near;
    const isPan = event.pointerType === "touch" || event.shiftKey || event.button === 1;
    drag = { kind: near >= 0 ? "cursor" : isPan ? "pan" : "zoom", from: left, to: left, far: false };
  });
  over.addEventListener("pointermove", (event) => {
    if (!drag || !fingers.has(event.pointerId)) return;
    const left = place(event);
    const before = fingers.get(event.pointerId)!;
    if (fingers.size === 2) {
      const other = [...fingers].find(([id]) => id !== event.pointerId)![1];
      const [was, is] = [Math.abs(before - other), Math.abs(left - other)];
      drag.far = true;
      if (was > NEAR && is > NEAR) view.zoom(was / is, sampleAt(other));
    } else {
      drag.far ||= Math.abs(left - drag.from) > STILL;
      if (drag.kind === "pan" && drag.far) view.pan((before - left) * perPixel());
      if (drag.kind === "cursor" && drag.far) view.move(sampleAt(left));
    }
    fingers.set(event.pointerId, left);
    drag.to = left;
    if (drag.kind !== "zoom") changed();
    else if (drag.far && fingers.size === 1) select(chart, drag.from, left);
  });
  const ended = (event: PointerEvent): void => {
    const one = drag;
    if (!fingers.delete(event.pointerId) || fingers.size || !one) return;
    drag = undefined;
    select(chart, 0, 0);
    if (event.type === "pointercancel") return;
    const [low, high] = [sampleAt(Math.min(one.from, one.to)), sampleAt(Math.max(one.from, one.to))];
    if (!one.far && one.kind !== "cursor") view.mark(gestures.snapped(low, NEAR * perPixel()));
    else if (one.far && one.kind === "zoom") view.show(low, high);
    changed();
  };
  over.addEventListener("pointerup", ended);
  over.addEventListener("pointercancel", ended);
  over.addEventListener("dblclick", () => (view.unmark(), view.all(), changed()));
  over.addEventListener("wheel", (event) => {
    // A page that is scrolled past a trend is not held up by it.
    if (!event.ctrlKey && document.activeElement !== element) return;
    event.preventDefault();
    view.zoom(event.deltaY > 0 ? WHEEL : 1 / WHEEL, sampleAt(place(event)));
    changed();
  }, { passive: false });
  element.addEventListener("keydown", (event) => {
    const action = event.ctrlKey || event.altKey || event.metaKey ? undefined : keyAction(view, event, perPixel());
    if (!action) return;
    // Keys of the page leave alone what is prevented.
    event.preventDefault();
    action();
    changed();
  });
}

function keyAction(view: View, { key, shiftKey }: KeyboardEvent, perPixel: number): (() => void) | undefined {
  const middle = (view.first + view.last) / 2;
  const step = Math.max(1, (shiftKey ? FAR : ARROW) * perPixel);
  const about = view.cursors[view.active] ?? (view.isFollowing ? view.last : middle);
  const move = (by: number): void => {
    const at = view.cursors[view.active];
    if (at === undefined) view.mark(middle);
    else view.move(by > 0 ? Math.ceil(at + by) : Math.floor(at + by));
  };
  const set = (which: number): void => {
    if (view.cursors[which] === undefined) view.mark(middle);
    else view.active = which;
  };
  const actions: Record<string, () => void> = {
    ArrowLeft: () => move(-step),
    ArrowRight: () => move(step),
    a: () => set(0),
    b: () => set(1),
    "+": () => view.zoom(1 / KEY, about),
    "-": () => view.zoom(KEY, about),
    PageUp: () => view.pan(-PAGE * view.length),
    PageDown: () => view.pan(PAGE * view.length),
    Home: () => view.all(),
    End: () => view.follow(),
    Escape: () => view.unmark(),
  };
  return actions[key];
}

function select(chart: uPlot, from: number, to: number): void {
  const left = Math.min(from, to);
  chart.setSelect({ left, width: Math.abs(to - from), top: 0, height: chart.over.clientHeight }, false);
}
