/** The ranking: its columns sort, and a tick shows a controller in all pictures. */

import type { Shown } from "./shown";

export function makeRanking(table: HTMLTableElement, shown: Shown): void {
  addTicks(table, shown);
  [...table.tHead!.rows[0]!.cells].slice(1).forEach((head) => addSort(table, head));
}

function addTicks(table: HTMLTableElement, shown: Shown): void {
  const head = document.createElement("th");
  head.scope = "col";
  head.textContent = "show";
  table.tHead!.rows[0]!.prepend(head);
  for (const row of table.tBodies[0]!.rows) {
    const controller = Number(row.dataset["controller"]);
    const tick = document.createElement("input");
    tick.type = "checkbox";
    tick.setAttribute("aria-label", `Show ${row.querySelector("th")!.textContent} in all pictures`);
    tick.addEventListener("change", () => shown.toggle(controller));
    row.insertCell(0).append(tick);
    const mark = () => {
      tick.checked = shown.has(controller);
      row.classList.toggle("shown", tick.checked);
      shown.paint(row, controller);
    };
    mark();
    shown.onChange(mark);
  }
}

function addSort(table: HTMLTableElement, head: HTMLTableCellElement): void {
  const button = document.createElement("button");
  button.append(...head.childNodes);
  head.append(button);
  button.addEventListener("click", () => {
    const falling = head.getAttribute("aria-sort") === "ascending";
    for (const other of table.tHead!.rows[0]!.cells) other.removeAttribute("aria-sort");
    head.setAttribute("aria-sort", falling ? "descending" : "ascending");
    const body = table.tBodies[0]!;
    const rows = [...body.rows].sort((a, b) => compared(a, b, head.cellIndex));
    body.append(...(falling ? rows.reverse() : rows));
  });
}

function compared(a: HTMLTableRowElement, b: HTMLTableRowElement, column: number): number {
  const [first, second] = [a.cells[column]!, b.cells[column]!];
  const [left, right] = [number(first), number(second)];
  if (left === undefined || right === undefined)
    return first.textContent!.localeCompare(second.textContent!);
  return left === right ? 0 : left - right;
}

function number({ dataset }: HTMLTableCellElement): number | undefined {
  const value = dataset["value"];
  return value === undefined ? undefined : value === "inf" ? Number.MAX_VALUE : Number(value);
}
