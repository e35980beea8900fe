"""The door of pages in a thread, over a plant whose samples a test goes through itself."""

import asyncio
import http.client
import threading
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import pytest
from rig_bench import bench
from tools import need
from waiting import wait_until

from clepsydra.rig.doors.page.cells import cells_of
from clepsydra.rig.doors.page.door import PageDoor
from clepsydra.rig.image import ProcessImage
from clepsydra.rig.report import Kind, Reporter
from clepsydra.rig.tag_table import TagTable

PAGE = "<!DOCTYPE html><title>rig</title><script>run()</script>"


@dataclass
class Served:
    """A door that serves."""

    bench: object
    port: int
    reports: list

    def connect(self, path="/rig", **options):
        from websockets.sync.client import connect

        return connect(f"ws://127.0.0.1:{self.port}{path}", compression=None, **options)

    def ask(self, path="/", method="GET", **headers):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=600)
        try:
            headers = {"Host": f"127.0.0.1:{self.port}", **headers}
            connection.request(method, path, headers=headers)
            answer = connection.getresponse()
            return answer.status, answer.headers, answer.read().decode()
        finally:
            connection.close()

    @property
    def told(self):
        return [report.words for report in self.reports if report.kind is Kind.EVENT]


@pytest.fixture
def serving(tmp_path):
    """Return a context in which a door serves."""
    need("websockets")

    @contextmanager
    def served(**options):
        with bench() as plant:
            page = tmp_path / "page.html"
            page.write_text(PAGE, encoding="utf-8")
            door = PageDoor(page, "plant", cells_of(plant.process, plant.table.tags.values()),
                            port=0, **options)  # fmt: skip
            reports = []
            loop = asyncio.new_event_loop()
            # As in a process of its own, it has mapped the image itself.
            image = ProcessImage(Path(plant.path), plant.settings.layout)
            serve = door.serve(TagTable(plant.table.tags.values(), image),
                               Reporter("page", reports.append))  # fmt: skip
            task = loop.create_task(serve)
            thread = threading.Thread(target=_run, args=(loop, task))
            thread.start()
            try:
                wait_until(lambda: reports or task.done())
                port = int(reports[0].words.split(":")[-1].strip("/"))
                yield Served(plant, port, reports)
            finally:
                loop.call_soon_threadsafe(task.cancel)
                thread.join()
                loop.close()

    return served


def _run(loop, task):
    with suppress(asyncio.CancelledError):
        loop.run_until_complete(task)
