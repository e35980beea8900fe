"""The fenced blocks of README and docs, and how each kind of them is run.

A comment before a block says what the text around it says to a reader:
`<!-- file: NAME -->`, that it is to be saved, and `<!-- not run: REASON -->`.
Blocks of a language that nothing here runs (c, js, iecst, csv, text) are no commands.
"""

import contextlib
import doctest
import os
import re
import shlex
import subprocess
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path

from clepsydra.cli.application import application

ROOT = Path(__file__).parents[1]
#: Lines that take long, each with the tests that run what it shows.
ELSEWHERE = {
    "clepsydra hil": "tests/cli/test_hil.py",
    "clepsydra rig my-tanks.toml": "tests/cli/test_rig.py",
    "clepsydra papers": "tests/cli/test_papers.py",
    "clepsydra study my-tanks.toml --json": "tests/cli/test_command.py",
    "clepsydra verify compare.toml": "tests/cli/test_verify.py",
    "clepsydra verify quadruple-tank": "tests/cli/test_verify.py",
}
PAGES = [
    path.relative_to(ROOT).as_posix()
    for path in (ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md")))
]
#: What makes the name of the program known in a reader's shell, as it is here already.
ACTIVATE = [".", ".venv/bin/activate"]
_BLOCK = re.compile(
    r"^(?:<!-- (?P<mark>file|not run): (?P<said>[^>]*) -->\n)?(?P<indent> *)```(?P<language>\w*)\n"
    r"(?P<text>.*?)^(?P=indent)```$",
    re.MULTILINE | re.DOTALL,
)


@dataclass(frozen=True)
class Block:
    """One fenced block: its page and line, its text, the file it is, why it is not run."""

    page: str
    line: int
    language: str
    text: str
    file: str
    not_run: str

    @property
    def place(self) -> str:
        return f"{self.page}:{self.line}"

    @property
    def table(self) -> dict:
        """What a block of TOML says."""
        return tomllib.loads(self.text)

    @property
    def kind(self) -> str:
        """The verb that takes a whole file of TOML; empty for a part of one."""
        if "tasks" in self.table:
            return "lab --no-open --lesson"
        if "process" in self.table:
            return "study"
        return "analyse" if "sampling_period" in self.table else ""

    @property
    def runs(self) -> bool:
        if self.not_run or self.language not in ("sh", "python", "pycon", "toml"):
            return False
        return self.language != "toml" or bool(self.file or self.kind)

    def run(self, folder: Path, names: dict) -> None:
        """Do in a folder what the block says; its Python shares names with that before it."""
        if self.language == "toml" or self.file:
            file = folder / (self.file or f"block-{self.line}.toml")
            file.write_text(self.text, encoding="utf-8")
            if self.language == "toml" and self.kind:
                shell(f"clepsydra {self.kind} {file.name}", folder, self.place)
        elif self.language == "sh":
            shell(self.text, folder, self.place)
        elif self.language == "pycon":
            examples(self, names)
        else:
            code = "\n" * self.line + self.text
            exec(compile(code, self.page, "exec"), names)


def blocks(page: str, *languages: str) -> list[Block]:
    """Return the blocks of a page, of these languages or all, in its order."""
    text = (ROOT / page).read_text(encoding="utf-8")
    found = [
        Block(
            page,
            text.count("\n", 0, match.start("language")) + 1,
            match["language"],
            match["text"],
            match["said"] if match["mark"] == "file" else "",
            match["said"] if match["mark"] == "not run" else "",
        )
        for match in _BLOCK.finditer(text)
    ]
    return [block for block in found if not languages or block.language in languages]


def lines(text: str) -> list[list[str]]:
    """Return the commands of a block, each as its words."""
    whole = re.sub(r"\\\n", " ", text)
    return [words for line in whole.splitlines() if (words := shlex.split(line, comments=True))]


def shell(text: str, folder: Path, place: str) -> None:
    """Run lines up to the first failure: `clepsydra` alone in this process, others in a shell."""
    commands = [words for words in lines(text) if words != ACTIVATE]
    of_shell = re.search(r"[|<>&;$*`]", re.sub(r"#.*", "", text))
    if not of_shell and all(program == "clepsydra" for program, *_ in commands):
        for words in commands:
            if not " ".join(words).startswith(tuple(ELSEWHERE)):
                command(words[1:], folder, place)
        return
    path = os.pathsep.join((str(Path(sys.executable).parent), os.environ["PATH"]))
    done = subprocess.run(
        ["bash", "-euxo", "pipefail", "-c", text],
        cwd=folder, env=os.environ | {"PATH": path}, stdin=subprocess.DEVNULL,
        capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, f"{place}\n{done.stdout[-2000:]}\n{done.stderr}"


def command(arguments: list[str], folder: Path, place: str) -> None:
    """Run the command line as its program would, which loads everything only once."""
    with contextlib.chdir(folder):
        try:
            application()(args=arguments)
        except SystemExit as ending:
            assert not ending.code, (place, arguments)


def examples(block: Block, names: dict) -> None:
    """Run what stands behind >>> and compare what stands below it."""
    test = doctest.DocTestParser().get_doctest(
        block.text, {}, block.place, str(ROOT / block.page), block.line
    )
    test.globs = names
    said: list[str] = []
    doctest.DocTestRunner().run(test, out=said.append, clear_globs=False)
    assert not said, "".join(said)
