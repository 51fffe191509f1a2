"""Progress: lines where nobody watches, silence where asked."""

from __future__ import annotations

from airlight.app import progress as module
from airlight.app.progress import progress


def test_a_line_per_stage(capsys):
    with progress() as report:
        for stage, fraction in [("load", 0.0), ("load", 1.0), ("solve", 0.5)]:
            report(stage, fraction)
    out, err = capsys.readouterr()
    assert (out, err) == ("", "load ...\nsolve ...\n")


def test_quiet(capsys):
    with progress(quiet=True) as report:
        report("load", 0.5)
    assert capsys.readouterr() == ("", "")


def test_a_bar_on_a_terminal_stays_off_stdout(capsys, monkeypatch):
    monkeypatch.setattr(module.sys.stderr, "isatty", lambda: True, raising=False)
    with progress() as report:
        report("load", 0.5)
    assert capsys.readouterr().out == ""
