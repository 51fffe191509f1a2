"""Progress: lines where nobody watches, silence where asked."""

from __future__ import annotations

from airlight.app import progress as module
from airlight.app.progress import Left, Lines, progress, spoken


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


def test_the_rest_of_the_time_follows_from_the_parts_that_are_done():
    clock = [0.0]
    left = Left(lambda: clock[0])
    left.note("render", 0.0)
    assert left.seconds is None  # nothing is done that could tell
    clock[0] = 10.0
    left.note("render", 0.25)
    assert left.seconds == 30.0
    clock[0] = 14.0
    assert left.seconds == 26.0  # time goes on between two notes
    clock[0] = 100.0
    assert left.seconds == 0.0
    # Another stage knows nothing of the one before, nor does the same one when it starts again.
    left.note("timing", 0.5)
    assert left.seconds is None
    left.note("timing", 0.1)
    assert left.seconds is None
    left.note("timing", 1.0)
    assert left.seconds is None


def test_long_stages_tell_a_log_how_far_they_are(capsys):
    clock = [0.0]
    lines = Lines(lambda: clock[0])
    for second, stage, fraction in [
        (0.0, "load", 0.0),
        (1.0, "render", 0.0),
        (11.0, "render", 0.125),
        (21.0, "render", 0.25),
        (31.0, "render", 0.375),
        (81.0, "render", 1.0),
    ]:
        clock[0] = second
        lines.report(stage, fraction)
    said = "load ...\nrender ...\nrender 25%, about 1 min 0 s left\n"
    assert capsys.readouterr().err == said


def test_times_as_they_are_said():
    assert [spoken(s) for s in (0.4, 59.4, 61.0, 3661.0)] == [
        "0 s",
        "59 s",
        "1 min 1 s",
        "1 h 1 min",
    ]
