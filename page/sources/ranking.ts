/** The ranking: its columns sort, and a tick shows a controller in all pictures. */

import type { Controller } from "./data";
import type { Shown } from "./shown";

/** What stands in a cell, and what it is sorted by. */
export interface Cell {
  text: string;
  number: number;
}

export class Ranking {
  constructor(
    private readonly table: HTMLTableElement,
    private readonly shown: Shown,
  ) {
    const head = document.createElement("th");
    head.scope = "col";
    head.textContent = "show";
    table.tHead!.rows[0]!.prepend(head);
    for (const row of table.tBodies[0]!.rows) this.addTick(row, Number(row.dataset["controller"]));
    [...table.tHead!.rows[0]!.cells].slice(1).forEach((head) => addSort(table, head));
  }

  /** Return what stands in the columns behind the standing of a controller. */
  cells(controller: number): string[] {
    return [...this.row(controller).querySelectorAll(".words ~ td")].map((cell) => cell.textContent!);
  }

  isRecommended(controller: number): boolean {
    return this.row(controller).querySelector("th .unit") !== null;
  }

  /** Add a controller that was not ranked, below all others. */
  append(controller: number, mark: string, { title, standing }: Controller, cells: Cell[]): void {
    const row = this.table.tBodies[0]!.insertRow();
    row.dataset["controller"] = String(controller);
    const name = document.createElement("th");
    name.scope = "row";
    name.textContent = title;
    row.append(cellOf({ text: mark, number: Infinity }), name);
    const words = cellOf({ text: standing, number: Infinity });
    words.className = "words";
    row.append(words, ...cells.map(cellOf));
    this.addTick(row, controller);
  }

  private row(controller: number): HTMLTableRowElement {
    return this.table.querySelector<HTMLTableRowElement>(`tr[data-controller="${controller}"]`)!;
  }

  private addTick(row: HTMLTableRowElement, controller: number): void {
    const tick = document.createElement("input");
    tick.type = "checkbox";
    tick.setAttribute("aria-label", `Show ${row.querySelector("th")!.textContent} in all pictures`);
    tick.addEventListener("change", () => this.shown.toggle(controller));
    row.insertCell(0).append(tick);
    const mark = () => {
      tick.checked = this.shown.has(controller);
      row.classList.toggle("shown", tick.checked);
      this.shown.paint(row, controller);
    };
    mark();
    this.shown.onChange(mark);
  }
}

function cellOf({ text, number }: Cell): HTMLTableCellElement {
  const cell = document.createElement("td");
  cell.textContent = text;
  cell.dataset["value"] = Number.isFinite(number) ? String(number) : "inf";
  return cell;
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
