/** When the page looks different, light or dark or on paper, its pictures are drawn anew. */

const listeners: (() => void)[] = [];

export function onLook(listener: () => void): void {
  listeners.push(listener);
}

function drawn(): void {
  for (const listener of listeners) listener();
}

/** Lay the page out as on paper while it is printed: pictures are as wide as what they stand in. */
function onPaper(paper: boolean): void {
  document.documentElement.classList.toggle("paper", paper);
  drawn();
}

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", drawn);
addEventListener("beforeprint", () => onPaper(true));
addEventListener("afterprint", () => onPaper(false));
