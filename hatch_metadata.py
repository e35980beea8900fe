"""Gives the package's page links that lead somewhere: those of README.md lead into a clone."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

#: The address of the repository, where it is not that of the clone's origin.
VARIABLE = "CLEPSYDRA_REPOSITORY"
_LINK = re.compile(r"(!?)\[([^\]]*)\]\((?!https?:|#)([^)\s]+)\)")
_SHORT = re.compile(r"(?:ssh://)?git@([\w.-]+)[:/](.+)")


class AddressHook(MetadataHookInterface):
    """Fills in what README.md says, and where the project is, when a package is built.

    A wheel that is built from a source distribution takes both from that.
    """

    def update(self, metadata: dict[str, Any]) -> None:
        """Add the fields that pyproject.toml calls dynamic."""
        root = Path(self.root)
        address = repository(root)
        text = published((root / "README.md").read_text("utf-8"), address)
        metadata["readme"] = {"content-type": "text/markdown", "text": text}
        metadata["urls"] = urls(address)


def repository(root: Path) -> str:
    """Return the address of the repository of a clone; empty where it has none on the web."""
    given = os.environ.get(VARIABLE, "")
    if not given and (root / ".git").exists():
        try:
            found = subprocess.run(
                ["git", "-C", str(root), "remote", "get-url", "origin"],
                capture_output=True,
                text=True,
            )
        except OSError:  # no git
            return ""
        given = found.stdout.strip() if found.returncode == 0 else ""
    given = _SHORT.sub(r"https://\1/\2", given).removesuffix("/").removesuffix(".git")
    # Whoever cloned with a name and a password does not want them printed.
    given = re.sub(r"^https://[^/@]+@", "https://", given)
    return given if given.startswith("https://") else ""


def urls(address: str) -> dict[str, str]:
    """Return the pages of a project whose repository has an address."""
    if not address:
        return {}
    pages = {"Documentation": "tree/HEAD/docs", "Changelog": "blob/HEAD/CHANGELOG.md"}
    return {"Repository": address} | {name: f"{address}/{page}" for name, page in pages.items()}


def published(text: str, address: str) -> str:
    """Return README.md with every link and picture at its address.

    Without an address there is nothing that a link could lead to: its words stay, and a picture
    goes.
    """

    def replaced(link: re.Match[str]) -> str:
        is_picture, words, path = link.groups()
        if address:
            return f"{is_picture}[{words}]({address}/{'raw' if is_picture else 'blob'}/HEAD/{path})"
        return "" if is_picture else words

    return _LINK.sub(replaced, text)
