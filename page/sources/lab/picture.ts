/** A trend as a picture for a report, with its title, on the paper of the page. */

import type uPlot from "uplot";

import { colour } from "../shown";

/** Of the curves [px]. */
const SIZE = { width: 1200, height: 420 };
/** Above and around them [px]. */
const [TITLE, ROOM] = [34, 12];

export async function pictureOf(chart: uPlot, title: string): Promise<Blob> {
  const { width, height } = chart;
  const scale = devicePixelRatio;
  const canvas = document.createElement("canvas");
  canvas.width = (SIZE.width + 2 * ROOM) * scale;
  canvas.height = (SIZE.height + TITLE + ROOM) * scale;
  const pen = canvas.getContext("2d")!;
  pen.fillStyle = colour("--paper");
  pen.fillRect(0, 0, canvas.width, canvas.height);
  pen.fillStyle = colour("--ink");
  pen.font = `${15 * scale}px system-ui, sans-serif`;
  pen.fillText(title, ROOM * scale, 24 * scale);
  // The chart draws itself in its next turn, before anybody sees it.
  chart.setSize(SIZE);
  await Promise.resolve();
  pen.drawImage(chart.ctx.canvas, ROOM * scale, TITLE * scale);
  chart.setSize({ width, height });
  return new Promise((done, failed) =>
    canvas.toBlob((blob) => (blob ? done(blob) : failed(new Error("this browser makes no pictures")))),
  );
}
