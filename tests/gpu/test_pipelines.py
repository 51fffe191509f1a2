"""Pipelines are made once for what they are made of."""

from __future__ import annotations

import threading

import pytest

from airlight.display.tone import Tone
from airlight.errors import DeviceError
from airlight.gpu.device import open_gpu
from airlight.gpu.pipelines import Pipelines


def test_what_differs_in_text_or_parts_is_made_again_and_what_does_not_is_kept():
    made, kept = [], Pipelines()

    def make():
        made.append(object())
        return made[-1]

    first = kept.get("fn a()", {"entry": "main"}, make)
    assert kept.get("fn a()", {"entry": "main"}, make) is first
    assert kept.get("fn b()", {"entry": "main"}, make) is not first
    assert kept.get("fn a()", {"entry": "other"}, make) is not first
    assert len(made) == len(kept) == 3


def test_the_one_unused_for_longest_goes_first():
    kept = Pipelines(most=2)
    a, b = (kept.get(text, (), object) for text in "ab")
    assert kept.get("a", (), object) is a
    kept.get("c", (), object)
    assert kept.get("a", (), object) is a
    assert kept.get("b", (), object) is not b
    assert len(kept) == 2


def test_what_is_begun_is_made_once_and_in_another_thread():
    made, kept = [], Pipelines()

    def make():
        made.append(threading.get_ident())
        return len(made)

    for _ in range(2):
        kept.begin("a", (), make)
    assert [kept.get("a", (), make) for _ in range(2)] == [1, 1]
    kept.begin("a", (), make)  # there already
    assert len(made) == 1 and made[0] != threading.get_ident()


def test_what_went_wrong_in_another_thread_is_raised_where_it_is_asked_for_and_tried_again():
    kept = Pipelines()

    def fail():
        raise DeviceError("no")

    kept.begin("a", (), fail)
    with pytest.raises(DeviceError, match="no"):
        kept.get("a", (), object)
    assert type(kept.get("a", (), object)) is object


def test_what_an_interrupt_kept_from_starting_is_made_by_who_asks_for_it(monkeypatch):
    def interrupted(self):
        raise KeyboardInterrupt

    kept = Pipelines()
    with monkeypatch.context() as patched, pytest.raises(KeyboardInterrupt):
        patched.setattr(threading.Thread, "start", interrupted)
        kept.begin("a", (), object)
    asked = threading.Thread(target=kept.get, args=("a", (), object), daemon=True)
    asked.start()
    asked.join(10.0)
    assert not asked.is_alive()
    assert len(kept) == 1


def test_a_second_pass_of_a_kind_compiles_nothing():
    try:
        gpu = open_gpu()
    except DeviceError as error:
        pytest.skip(str(error))
    Tone(gpu, (8, 8))
    before = len(gpu.pipelines)
    Tone(gpu, (12, 5))
    assert len(gpu.pipelines) == before
