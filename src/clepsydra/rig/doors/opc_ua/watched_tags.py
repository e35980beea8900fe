"""Who watches which tags: values go from a sample of the plant to the subscriptions at once."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from asyncua import ua

from clepsydra.rig.doors.opc_ua.deadband import ChangeFilter
from clepsydra.rig.doors.opc_ua.tag_values import TagValues
from clepsydra.rig.doors.opc_ua.told_value import ToldValue
from clepsydra.rig.tag import Tag


@dataclass(eq=False)
class WatchedTag:
    """A monitored item of a tag's value.

    Parameters
    ----------
    tag : Tag
    number : int
        Of the monitored item.
    client_handle : int
    mode : ua.MonitoringMode
    passing : ChangeFilter
    queue_size : int
    discard_oldest : bool
    """

    tag: Tag
    number: int
    client_handle: int
    mode: ua.MonitoringMode
    passing: ChangeFilter
    queue_size: int
    discard_oldest: bool
    _told: ToldValue | None = field(default=None, repr=False)
    _waiting: deque[tuple[ToldValue, bool]] = field(default_factory=deque, repr=False)

    def tell(self, told: ToldValue) -> bool:
        """Take a value where its filter lets it pass, and return whether there is news."""
        if self.mode == ua.MonitoringMode.Disabled:
            return False
        last = self._told
        if last is not None and not self.passing.passes(
            (last.value, last.status), (told.value, told.status)
        ):
            return False
        # What is compared with is the last value that was pushed to the queue.
        self._told = told
        waiting = self._waiting
        full = len(waiting) >= self.queue_size
        lost = full and self.queue_size > 1
        if full and self.discard_oldest:
            waiting.popleft()
            if lost:
                waiting[0] = (waiting[0][0], True)
        elif full:
            waiting.pop()
        waiting.append((told, lost and not self.discard_oldest))
        return self.mode == ua.MonitoringMode.Reporting

    @property
    def waits(self) -> bool:
        """Whether values wait to be told."""
        return bool(self._waiting)

    def resize(self, queue_size: int) -> None:
        """Let more or fewer values wait; the newest stay."""
        self.queue_size = queue_size
        while len(self._waiting) > queue_size:
            self._waiting.popleft()

    def forget(self) -> None:
        """Tell the next value whatever it is, and none of those that wait."""
        self._told = None
        self._waiting.clear()

    def taken(self) -> list[bytes]:
        """Return the values that wait, each with the client's handle, as a message has them."""
        handle = self.client_handle.to_bytes(4, "little")
        found = [
            handle + (told.after_a_loss() if lost else told.encoded())
            for told, lost in self._waiting
        ]
        self._waiting.clear()
        return found


class WatchedTags:
    """The tags with those who watch them.

    Parameters
    ----------
    values : TagValues
    nodes : dict
        Name of a tag to its node.
    tags : dict
        Name to tag.
    """

    def __init__(
        self, values: TagValues, nodes: dict[str, ua.NodeId], tags: dict[str, Tag]
    ) -> None:
        self.values = values
        self._tags = {node: tags[name] for name, node in nodes.items()}
        self._watching: dict[str, dict[WatchedTag, Callable[[WatchedTag], None]]] = {}
        values.look()

    def tag_of(self, node: ua.NodeId) -> Tag | None:
        """Return the tag of a node; None where it is of none."""
        return self._tags.get(node)

    def watch(self, item: WatchedTag, news: Callable[[WatchedTag], None]) -> None:
        """Tell an item what its tag shows, now and from now on; `news` is called where it has."""
        self._watching.setdefault(item.tag.name, {})[item] = news
        self.tell(item, news)

    def tell(self, item: WatchedTag, news: Callable[[WatchedTag], None]) -> None:
        """Tell an item what its tag shows now."""
        if item.tell(self.values.told(item.tag.name)):
            news(item)

    def leave(self, item: WatchedTag) -> None:
        """Tell an item nothing more."""
        watching = self._watching.get(item.tag.name, {})
        watching.pop(item, None)
        if not watching:
            self._watching.pop(item.tag.name, None)

    def look(self) -> None:
        """Look at the plant, and tell everybody what has changed."""
        self._push(self.values.look())

    def look_at(self, tag: Tag) -> None:
        """Look at one tag, as after it was written."""
        self._push(self.values.look_at(tag.name))

    def _push(self, changes: Iterable[tuple[str, ToldValue]]) -> None:
        for name, told in changes:
            for item, news in self._watching.get(name, {}).items():
                if item.tell(told):
                    news(item)
