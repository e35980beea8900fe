"""The command line, run inside the test's own folder."""

import pytest

from clepsydra.cli import main


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
