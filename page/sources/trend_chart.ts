import uPlot from "uplot";

import type { Panel, Trends } from "./data";

const HEIGHT = 190;

/** Draw the panels of a run into a place of the page; they share their cursor and their zoom. */
export function drawTrends(place: HTMLElement, { unit, time, panels }: Trends): void {
  const charts = panels.map((panel, row) => {
    const below = row === panels.length - 1 ? `time [${unit}]` : "";
    const columns: uPlot.AlignedData = [time, ...panel.curves.map((curve) => curve.values)];
    return new uPlot(options(place.clientWidth, panel, below), columns, place);
  });
  new ResizeObserver(() => {
    for (const chart of charts) chart.setSize({ width: place.clientWidth, height: HEIGHT });
  }).observe(place);
}

function options(width: number, { unit, curves }: Panel, below: string): uPlot.Options {
  return {
    width,
    height: HEIGHT,
    scales: { x: { time: false } },
    axes: [{ label: below, labelSize: below ? 22 : 0 }, { label: unit, labelSize: 22, size: 56 }],
    cursor: { sync: { key: "trends", scales: ["x", null] } },
    series: [
      { label: "time" },
      ...curves.map(({ name, colour, dashed }) => ({
        label: name,
        stroke: colour,
        width: 1.5,
        ...(dashed ? { dash: [4, 3] } : {}),
      })),
    ],
  };
}
