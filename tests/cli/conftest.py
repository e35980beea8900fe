"""The command line, run inside the test's own folder."""

import pytest

from clepsydra.cli import main
from clepsydra.cli.output import show

#: Of terminals, and the last one where no line has to be broken [columns].
_WIDTHS = (80, 100, 1000)


@pytest.fixture
def command(capsys, tmp_path, monkeypatch):
    """Return a function: arguments → (exit status, standard output, standard error)."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments):
        try:
            main(list(arguments))
            status = 0
        except SystemExit as ending:
            status = 0 if ending.code is None else int(ending.code)
        captured = capsys.readouterr()
        return status, captured.out, captured.err

    return run


@pytest.fixture
def at_widths(command, capsys, monkeypatch):
    """Return a function: arguments → what a verb prints at each width.

    The verb runs once. Nothing but `show` asks how wide the terminal is, and it shows the result
    at each width here.
    """
    told = {}

    def shown(result):
        for width in _WIDTHS:
            monkeypatch.setenv("COLUMNS", str(width))
            show(result)
            told[width] = capsys.readouterr().out

    monkeypatch.setattr("clepsydra.cli.output.show", shown)

    def run(*arguments):
        status, after, errors = command(*arguments)
        assert (status, errors) == (0, "")
        return {width: text + after for width, text in told.items()}

    return run
