"""One thread at a time: a second one is told at once, not kept waiting."""

from __future__ import annotations

import threading

import pytest

from airlight.errors import DeviceError
from airlight.gpu.lifetime import OneThread


def entering(context: OneThread) -> str:
    """What a second thread is told."""
    said = []

    def enter() -> None:
        try:
            with context:
                said.append("")
        except DeviceError as error:
            said.append(str(error))

    thread = threading.Thread(target=enter)
    thread.start()
    thread.join()
    return said[0]


def test_a_second_thread_is_refused_until_the_first_has_left():
    context = OneThread("this lamp")
    with context:
        with context:
            pass
        assert entering(context) == (
            "this lamp is used by two threads at once. "
            "Make a Renderer for each thread, or a lock around the one that they share"
        )
    assert entering(context) == ""


def test_an_error_inside_leaves_it_to_others():
    context = OneThread("this lamp")
    with pytest.raises(KeyError), context:
        raise KeyError
    assert entering(context) == ""
