import { addCopyButton } from "./copy";
import { pageData } from "./data";
import { drawEvents } from "./events";
import { fillWhenOpened, letScroll } from "./folds";
import { addLive } from "./live/live";
import { drawMap } from "./map";
import { Ranking } from "./ranking";
import { drawSensitivity } from "./sensitivity";
import { Shown } from "./shown";

fillWhenOpened();
letScroll();
const data = pageData();
const ranking = document.querySelector<HTMLTableElement>("table.ranking");
const [overlay, map, sensitivity] = ["overlay", "map", "sensitivity"].map((id) => document.getElementById(id));
if (data && overlay && map && sensitivity && ranking) {
  const shown = new Shown(data.first);
  const take = drawEvents(overlay, data, shown);
  const ranked = new Ranking(ranking, shown);
  const addPoint = drawMap(map, data.controllers, shown);
  const takeSensitivity = drawSensitivity(sensitivity, data, shown);
  addLive(overlay, data, { shown, ranking: ranked, take, addPoint, takeSensitivity });
  addCopyButton(document.querySelector<HTMLElement>(".card")!);
}
