"""Who does a lesson in a browser: `Pupil(opened(page, first=KEPT))`."""

from lab_hand import Hand


class Pupil(Hand):
    """Who does a lesson."""

    def __init__(self, page):
        super().__init__(page)
        self.panel = page.locator("#lesson")

    def begin(self, task):
        self.panel.get_by_label("Task").select_option(task)
        self.press("Set up the rig")

    def focused(self):
        """Return the name of what has the focus."""
        return self.page.evaluate(
            "(document.activeElement.ariaLabel ?? document.activeElement.textContent).trim()"
        )

    def reached(self):
        return self.panel.locator(".reach .done").count()

    def figure(self, words):
        """Return the number that was measured."""
        return float(self._row(words).locator(".verdict").inner_text().split()[0])

    def answer(self, words, text):
        """Type a figure, and return the verdict."""
        field = self._row(words).get_by_role("textbox")
        field.fill(text)
        field.press("Tab")
        return self._row(words).locator(".verdict").inner_text()

    def _row(self, words):
        return self.panel.locator(".figure", has_text=words)
