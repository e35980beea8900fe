/** Every controller as a point: to the left is robust, below a small error. */

import uPlot from "uplot";

import { decades, limitLine, logAxis } from "./axes";
import { type Controller, PEAK_LIMIT } from "./data";
import { onLook } from "./look";
import { colour, type Shown } from "./shown";
import { numberText } from "./words";

const HEIGHT = 300;
/** Beyond these a controller is out of the question, and stands at the edge. */
const [WORST_PEAK, WORST_ERROR] = [10, 1000];
/** How far beyond all others those without a number stand. */
const BEYOND = 1.3;
/** From the middle of a number to its edge [px]. */
const RADIUS = 9;

/** Adds a point for a controller, marked so. */
export type AddPoint = (controller: number, mark: string) => void;

/** From left and top [px]. */
type Place = [number, number];

interface Point {
  controller: number;
  x: number;
  y: number;
  button: HTMLButtonElement;
}

export function drawMap(place: HTMLElement, controllers: Controller[], shown: Shown): AddPoint {
  const edges = [
    edge([PEAK_LIMIT, ...controllers.map(({ peak }) => peak)], WORST_PEAK),
    edge(controllers.map(({ error }) => error), WORST_ERROR),
  ] as const;
  const pointOf = (controller: number, mark: string): Point => {
    const each = controllers[controller]!;
    return {
      controller,
      x: Math.min(each.peak ?? Infinity, edges[0]),
      y: Math.min(each.error ?? Infinity, edges[1]),
      button: pointButton(each, controller, mark, shown),
    };
  };
  const points = controllers.flatMap((each, controller) =>
    each.peak === null && each.standing !== "unsafe" ? [] : [pointOf(controller, String(controller + 1))],
  );
  if (points.length < 2) return () => undefined;
  const title = document.createElement("h3");
  title.textContent = "Error against robustness";
  const words = document.createElement("p");
  words.className = "note";
  const hint = document.createElement("span");
  hint.className = "hint";
  hint.textContent = " A click shows it in all pictures.";
  const away = points.some(({ controller, x, y }) => x !== controllers[controller]!.peak || y !== controllers[controller]!.error);
  words.append(
    "Each number is a controller at its rank; to the left of the line it is robust, the lower, the smaller its error.",
    away ? " What stands at the upper or right edge lies beyond it." : "",
    hint,
  );
  const canvas = document.createElement("div");
  place.append(title, words, canvas);
  const draw = () => {
    canvas.replaceChildren();
    drawn(canvas, points);
  };
  draw();
  new ResizeObserver(draw).observe(place);
  onLook(draw);
  return (controller, mark) => {
    points.push(pointOf(controller, mark));
    draw();
  };
}

/** Return where those stand that have no number, or a larger one than the worst. */
function edge(numbers: (number | null)[], worst: number): number {
  return Math.min(worst, BEYOND * Math.max(...numbers.filter((each) => each !== null)));
}

function drawn(canvas: HTMLElement, points: Point[]): void {
  const sorted = [...points].sort((a, b) => a.x - b.x);
  const bounds = (least: number, numbers: number[]): [number, number] => {
    const [low, high] = [Math.min(least, ...numbers), Math.max(2.2, ...numbers)];
    const margin = Math.max(1.09, (high / low) ** 0.05);
    return [low / margin, high * margin];
  };
  const place = (chart: uPlot) => {
    limitLine(chart, "x", PEAK_LIMIT);
    const { ctx, bbox, over } = chart;
    const wall = chart.valToPos(PEAK_LIMIT, "x");
    const taken: Place[] = [];
    ctx.strokeStyle = colour("--muted");
    for (const { x, y, button } of points) {
      const own: Place = [chart.valToPos(x, "x"), chart.valToPos(y, "y")];
      const room: Place = x > PEAK_LIMIT ? [wall, over.clientWidth - RADIUS] : [RADIUS, wall + 1];
      const found = freePlace(own, taken, room, over.clientHeight);
      taken.push(found);
      Object.assign(button.style, { left: `${found[0]}px`, top: `${found[1]}px` });
      over.append(button);
      ctx.beginPath();
      for (const [left, top] of [own, found])
        ctx.lineTo(bbox.left + left * devicePixelRatio, bbox.top + top * devicePixelRatio);
      ctx.stroke();
    }
  };
  const xs = sorted.map(({ x }) => x);
  const ys = sorted.map(({ y }) => y);
  new uPlot(
    {
      width: Math.max(280, canvas.clientWidth),
      height: HEIGHT,
      legend: { show: false },
      cursor: { show: false },
      scales: {
        x: { time: false, distr: 3, range: () => bounds(1, xs) },
        y: { distr: 3, range: () => bounds(Infinity, ys) },
      },
      axes: [
        logAxis("max|S|, smaller is more robust", 24, near),
        logAxis("relative error", 42, near),
      ],
      hooks: { drawAxes: [place] },
      series: [{}, { show: true, paths: () => null, points: { show: false } }],
    },
    [xs, ys],
    canvas,
  );
}

/** Return round numbers, closer together where little lies between the ends. */
function near(low: number, high: number): number[] {
  const size = Math.log10(high / low);
  if (size > 2.5) return decades(low, high, [1]);
  return decades(low, high, size > 0.8 ? [1, 2, 5] : [1, 1.2, 1.5, 2, 3, 4, 5, 7]);
}

/** Return the place nearest to a point where its number covers no other, on its side of the limit. */
function freePlace(own: Place, taken: Place[], [first, last]: Place, height: number): Place {
  const ROOM = 20;
  for (let radius = 0; radius < 150; radius += 4)
    for (let turn = 0; turn < 16; turn += 1) {
      const left = own[0] + radius * Math.cos((turn * Math.PI) / 8);
      const top = own[1] - radius * Math.sin((turn * Math.PI) / 8);
      const inside = left >= first && left <= last && top >= RADIUS && top <= height - RADIUS;
      if (inside && taken.every(([a, b]) => Math.hypot(left - a, top - b) >= ROOM)) return [left, top];
    }
  return own;
}

function pointButton(each: Controller, controller: number, mark: string, shown: Shown): HTMLButtonElement {
  const button = document.createElement("button");
  button.textContent = mark;
  const { standing } = each;
  button.className = `point ${standing.replaceAll(" ", "-")}`;
  const numbers = `max|S| ${numberText(each.peak ?? Infinity, 3)}, relative error ${numberText(each.error ?? Infinity, 3)}`;
  button.title = `${mark}. ${each.title}: ${standing}, ${numbers}`;
  button.setAttribute("aria-label", button.title);
  const press = () => {
    button.setAttribute("aria-pressed", String(shown.has(controller)));
    shown.paint(button, controller);
  };
  press();
  shown.onChange(press);
  button.addEventListener("click", () => shown.toggle(controller));
  return button;
}
