import { trends } from "./data";
import { drawTrends } from "./trend_chart";

const run = trends();
const still = document.querySelector<HTMLElement>("[data-interactive] svg");
if (run && still) {
  const place = document.createElement("div");
  place.className = "interactive";
  still.replaceWith(place);
  drawTrends(place, run);
}
