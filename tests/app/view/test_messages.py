"""What a page may say: events with values of their kinds, and nothing else."""

from __future__ import annotations

import pytest

from airlight.app.view.messages import believed


def test_events_are_believed_within_reason():
    move = {"type": "pointer_move", "x": 1, "y": 2}
    assert believed(move) == {**move, "timestamp": 0.0}
    huge = {"type": "resize", "pwidth": 10**9, "pheight": 5, "ratio": 2}
    assert believed(huge) == {**huge, "pwidth": 4096, "ratio": 2.0}


@pytest.mark.parametrize(
    "event",
    [
        {"type": "close"},
        {"type": "_clients_change", "ids": [9]},
        {"type": 3},
        {},
        7,
        None,
        [],
        {"type": "pointer_move"},
        {"type": "pointer_move", "x": "1", "y": 2},
        {"type": "pointer_move", "x": None, "y": 2},
        {"type": "pointer_move", "x": 1e400, "y": 2},
        {"type": "pointer_move", "x": 10**400, "y": 2},
        {"type": "pointer_down", "x": 1, "y": 2, "button": [1]},
        {"type": "pointer_down", "x": 1, "y": 2, "button": 1, "buttons": 7},
        {"type": "pointer_down", "x": 1, "y": 2, "button": 1, "modifiers": [["a"]]},
        {"type": "wheel", "x": 1, "y": 2, "dx": 0},
        {"type": "key_down"},
        {"type": "key_down", "key": {}},
        {"type": "key_down", "key": "x" * 10_000},
        {"type": "key_down", "key": "a", "timestamp": "now"},
        {"type": "_framefeedback"},
        {"type": "_framefeedback", "index": "a", "timestamp": 0, "localtime": 0},
        {"type": "resize"},
        {"type": "resize", "pwidth": 0, "pheight": 300, "ratio": 1},
        {"type": "resize", "pwidth": "many", "pheight": 300, "ratio": 1},
        {"type": "resize", "pwidth": 9, "pheight": 9, "ratio": float("nan")},
        {"type": "resize", "pwidth": float("inf"), "pheight": 9, "ratio": 1},
    ],
)
def test_events_that_are_not(event):
    assert believed(event) is None


def test_what_renderview_sends_is_believed():
    pointer = {
        "x": 1.5,
        "y": 2,
        "button": 1,
        "buttons": [1],
        "modifiers": ["Shift"],
        "ntouches": 0,
        "touches": {},
        "timestamp": 1.7e12,
    }
    for kind in ("pointer_down", "pointer_move", "pointer_up", "pointer_enter", "double_click"):
        event = {"type": kind, **pointer}
        assert believed(event) == event
    feedback = {"type": "_framefeedback", "index": 3, "timestamp": 1.7e9, "localtime": 1.7e9}
    assert believed(feedback) == feedback
    key = {"type": "key_down", "key": "a", "modifiers": [], "timestamp": 0.5}
    assert believed(key) == key
