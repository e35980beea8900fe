/** The panel of a lesson: a task at a time, what it reached, its figures, and the report of all. */

import { element } from "./faceplates.ts";
import { judgedField } from "./figure_field.ts";
import { measuredText, verdict } from "./judged.ts";
import type { LessonData, TaskData } from "./lesson_data.ts";
import { LessonReport } from "./lesson_report.ts";
import { NoteBook, type TaskNotes } from "./lesson_notes.ts";
import { paragraphs } from "./paragraphs.ts";
import { type SeenRun, Watched } from "./watched.ts";

export class Lesson {
  private readonly place: HTMLElement;
  private readonly data: LessonData;
  private readonly period: number;
  private readonly begin: (task: TaskData) => void;
  private readonly run: () => SeenRun;
  private readonly say: (words: string) => void;
  private readonly book: NoteBook;
  private readonly report: LessonReport;
  private watched: Watched | undefined;
  private updates: (() => void)[] = [];

  /**
   * @param begin Sets the rig up as a task asks for.
   * @param run The run that is going on.
   * @param say Tells who does not see the panel what was reached.
   * @param made Which page this is, for the report.
   */
  constructor(
    place: HTMLElement, data: LessonData, period: number, begin: (task: TaskData) => void, run: () => SeenRun, say: (words: string) => void,
    made: string,
  ) {
    this.place = place;
    this.data = data;
    this.period = period;
    this.begin = begin;
    this.run = run;
    this.say = say;
    this.book = new NoteBook(`${data.name} ${data.variant}`, data.tasks.map(({ figures }) => figures.length));
    this.report = new LessonReport(data, this.book, made);
    this.build();
  }

  /** Look at what the run has done since, and tell it. */
  show(): void {
    const { watched } = this;
    if (watched && watched.task === this.task) {
      watched.look(this.run());
      const { own } = this;
      const before = JSON.stringify([own.reached, own.measured]);
      for (const { words } of this.task.reach.slice(own.reached, watched.steps)) this.say(`Reached: ${words}`);
      own.reached = Math.max(own.reached, watched.steps);
      const found = watched.measured();
      own.measured = own.measured.map((value, place) => found[place] ?? value);
      if (JSON.stringify([own.reached, own.measured]) !== before) this.changed();
    }
    for (const update of this.updates) update();
  }

  private get task(): TaskData {
    return this.data.tasks[this.book.notes.task]!;
  }

  private get own(): TaskNotes {
    return this.book.notes.tasks[this.book.notes.task]!;
  }

  private changed(): void {
    this.book.keep();
    this.report.build();
  }

  private build(): void {
    const { data, task } = this;
    const { notes } = this.book;
    this.updates = [];
    const head = element("header", "");
    const variant = data.variant ? `, variant ${data.variant}` : "";
    head.append(element("h2", "", `${data.title}${variant}${data.answers ? ", with answers" : ""}`), this.steering());
    const text = element("div", "asked");
    if (!notes.task) text.append(...paragraphs(data.text));
    text.append(element("h3", "", `${notes.task + 1}. ${task.title}`), ...paragraphs(task.text), ...this.hints());
    if (task.solution.length) {
      const solution = element("div", "solution");
      solution.append(element("h4", "", "Solution"), ...paragraphs(task.solution));
      text.append(solution);
    }
    const work = element("div", "work");
    const figures = element("div", "to-find");
    figures.append(...this.figures());
    work.append(this.beginning(), this.steps(), figures);
    const task_ = element("div", "task");
    task_.append(text, work);
    this.place.replaceChildren(head, task_, this.report.place);
    this.report.build();
    this.show();
  }

  private steering(): HTMLElement {
    const row = element("div", "steering");
    const label = element("label", "", "Task ");
    const select = element("select", "");
    this.data.tasks.forEach(({ title }, place) => select.append(element("option", "", `${place + 1}. ${title}`)));
    select.selectedIndex = this.book.notes.task;
    select.addEventListener("change", () => this.go(select.selectedIndex));
    label.append(select);
    const back = element("button", "", "Back");
    const next = element("button", "", "Next");
    back.disabled = !this.book.notes.task;
    next.disabled = this.book.notes.task === this.data.tasks.length - 1;
    back.addEventListener("click", () => this.go(this.book.notes.task - 1));
    next.addEventListener("click", () => this.go(this.book.notes.task + 1));
    const print = element("button", "", "Print report");
    print.addEventListener("click", () => window.print());
    row.append(label, back, next, print);
    return row;
  }

  private go(task: number): void {
    this.book.notes.task = task;
    this.book.keep();
    this.build();
    this.place.querySelector("select")!.focus();
  }

  private beginning(): HTMLElement {
    const row = element("p", "beginning");
    const button = element("button", "", "Set up the rig");
    button.addEventListener("click", () => {
      this.begin(this.task);
      this.watched = new Watched(this.task, this.run(), this.period);
      this.show();
    });
    const told = element("span", "", "");
    this.updates.push(() => {
      const isUnderWay = this.watched?.task === this.task;
      const words = isUnderWay ? "under way" : "begins the task";
      if (told.textContent !== words) told.textContent = words;
    });
    row.append(button, " ", told);
    return row;
  }

  private steps(): HTMLElement {
    const list = element("ol", "reach");
    this.task.reach.forEach((step, place) => {
      const item = element("li", "", "");
      const mark = element("span", "mark", "");
      item.append(mark, " ", step.words);
      this.updates.push(() => {
        const isReached = place < this.own.reached;
        const isNext = this.watched?.task === this.task && place === this.watched.steps;
        const part = isNext && step.samples > 1 ? ` ${Math.floor(100 * this.watched!.share)} %` : "";
        const words = isReached ? "✓ reached" : isNext ? `…${part}` : "–";
        if (mark.textContent !== words) mark.textContent = words;
        item.classList.toggle("done", isReached);
      });
      list.append(item);
    });
    return list;
  }

  private figures(): HTMLElement[] {
    const { own, task, data } = this;
    return task.figures.map((figure, place) => {
      const field = judgedField(figure, own.typed[place]!, data.answers, (text) => {
        own.typed[place] = text;
        this.changed();
        return verdict(figure, text);
      });
      if (figure.measure)
        this.updates.push(() => {
          const value = own.measured[place];
          field.tell(value === null || value === undefined ? "" : measuredText(figure, value));
        });
      return field.place;
    });
  }

  private hints(): HTMLElement[] {
    const { own, task, data } = this;
    if (!task.hints.length) return [];
    const list = element("ol", "hints");
    const more = element("button", "", "");
    const fill = (): void => {
      const shown = data.answers ? task.hints.length : own.hints;
      list.replaceChildren(...task.hints.slice(0, shown).map((hint) => element("li", "", hint)));
      list.hidden = !shown;
      more.hidden = shown >= task.hints.length;
      more.textContent = task.hints.length === 1 ? "Hint" : `Hint ${shown + 1} of ${task.hints.length}`;
    };
    more.addEventListener("click", () => {
      own.hints += 1;
      this.changed();
      fill();
    });
    fill();
    return [list, more];
  }
}
