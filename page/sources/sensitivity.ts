/** How robust the loops are over frequency: the largest singular value of S, of what is shown. */

import uPlot from "uplot";

import { decades, limitLine, logAxis } from "./axes";
import { PEAK_LIMIT, type PageData } from "./data";
import { onLook } from "./look";
import { colour, type Shown } from "./shown";
import { numberText } from "./words";

const HEIGHT = 300;
const LOWEST = 0.05;

/** Takes the curve of a controller. */
export type TakeSensitivity = (controller: number, curve: (number | null)[]) => void;

export function drawSensitivity(place: HTMLElement, data: PageData, shown: Shown): TakeSensitivity {
  const { sensitivity, controllers } = data;
  if (!sensitivity) return () => undefined;
  const { frequencies, curves } = sensitivity;
  const title = document.createElement("h3");
  title.textContent = "Sensitivity";
  const words = document.createElement("p");
  words.className = "note";
  const explained = "Largest singular value of S: how much of a disturbance is left at each frequency; above 1 it is amplified, and the line is the limit.";
  const canvas = document.createElement("div");
  place.append(title, words, canvas);
  let chart: uPlot | undefined;
  const tell = () => {
    const at = chart?.cursor.idx ?? null;
    words.textContent = at === null ? explained : told(at);
  };
  const told = (at: number) =>
    [
      `${numberText(frequencies[at]!, 3)} rad/s`,
      ...shown.controllers.flatMap((each) => {
        const value = curves[each]?.[at] ?? null;
        return value === null ? [] : [`${controllers[each]!.title} ${numberText(value, 3)}`];
      }),
    ].join(" · ");
  let [isSeen, isStale] = [false, false];
  const draw = () => {
    isStale = false;
    const { left, top } = chart?.cursor ?? {};
    chart?.destroy();
    const drawn = shown.controllers.filter((each) => curves[each]);
    const values = drawn.flatMap((each) => curves[each]!).filter((each) => each !== null);
    const highest = 1.1 * Math.max(3, ...(values as number[]));
    // From where all curves are known on, and one of them is felt.
    const felt = frequencies.find((_, place) => {
      const sizes = drawn.map((each) => curves[each]![place] ?? null);
      return sizes.every((size) => size !== null) && sizes.some((size) => size! > LOWEST);
    });
    const lowest = felt ?? frequencies[0]!;
    chart = new uPlot(
      {
        width: Math.max(280, canvas.clientWidth),
        height: HEIGHT,
        legend: { show: false },
        cursor: { points: { size: 6 }, drag: { x: true, y: false } },
        scales: {
          x: { time: false, distr: 3, range: (_, low, high) => [Math.max(low, lowest), high] },
          y: { distr: 3, range: () => [LOWEST, highest] },
        },
        axes: [
          logAxis("frequency [rad/s]", 24, (low, high) => decades(low, high, [1])),
          logAxis("|S|", 42, (low, high) => decades(low, high, [1, 2, 5])),
        ],
        hooks: {
          drawAxes: [(chart) => limitLine(chart, "y", PEAK_LIMIT)],
          setCursor: [tell],
        },
        series: [
          {},
          ...drawn.map((each) => ({
            stroke: colour(shown.property(each)), width: 1.6, dash: shown.dash(each), points: { show: false },
          })),
        ],
      },
      [frequencies, ...drawn.map((each) => curves[each]!)] as uPlot.AlignedData,
      canvas,
    );
    // Who reads it there goes on to, of what is shown now.
    if (left !== undefined && top !== undefined && left >= 0) chart.setCursor({ left, top });
    tell();
  };
  draw();
  shown.onChange(draw);
  new ResizeObserver(() => chart?.setSize({ width: Math.max(280, place.clientWidth), height: HEIGHT })).observe(place);
  onLook(draw);
  const refresh = () => isSeen && isStale && draw();
  new IntersectionObserver(([entry]) => {
    isSeen = entry!.isIntersecting;
    refresh();
  }).observe(canvas);
  return (controller, curve) => {
    curves[controller] = curve;
    isStale = true;
    refresh();
  };
}
