"""Work behind the viewer's back: its frames come first, and it can be held and broken off."""

from __future__ import annotations

import threading
import time

import pytest

from airlight.app.view.build import Task, Turns, said
from airlight.display.tone import Tone
from airlight.errors import SettingsError
from airlight.gpu.memory import Buffer, Texture

_LONG_S = 20.0


class Toning:
    """Passes of the device, one after the other, counted."""

    def __init__(self, gpu) -> None:
        self.gpu, self.done = gpu, 0
        self.image = Texture(gpu, "image", (8, 8), "rgba32float", target=True)

    def __call__(self, commands) -> int:
        tone = Tone(self.gpu, (8, 8))
        metered = Buffer(self.gpu, "stops", 16)
        for _ in range(1000):
            tone.encode(
                commands,
                self.image,
                metered,
                is_metered=False,
                exposure_stops=0.0,
                curve="agx",
                is_raw=False,
            )
            commands.submit()
            self.done += 1
        return self.done


def until(is_so) -> None:
    end = time.monotonic() + _LONG_S
    while not is_so():
        assert time.monotonic() < end
        time.sleep(0.005)


def test_no_pass_is_handed_over_during_a_frame(gpu):
    turns, toning = Turns(), Toning(gpu)
    with turns.frame():
        task = Task(gpu, turns, toning)
        time.sleep(0.1)
        assert toning.done == 0
        with turns.frame():  # frames have parts
            pass
        time.sleep(0.05)
        assert toning.done == 0
    until(lambda: toning.done > 3)
    with turns.frame():
        before = toning.done
        time.sleep(0.1)
        assert toning.done <= before + 1  # the one that was waited for
    task.stop()
    task.wait()
    assert task.result() is None
    assert toning.done < 1000


def test_held_work_goes_on_where_it_was(gpu):
    turns, toning = Turns(), Toning(gpu)
    task = Task(gpu, turns, toning)
    until(lambda: toning.done > 3)
    task.pause(holds=True)
    time.sleep(0.1)
    before = toning.done
    time.sleep(0.1)
    assert toning.done == before
    assert not task.is_done
    task.pause(holds=False)
    until(lambda: toning.done > before)
    task.pause(holds=True)
    task.stop()  # also while it is held
    task.pause(holds=True)
    task.wait()


def test_what_work_raises_is_raised_where_it_is_asked_for(gpu):
    def bad(commands):
        raise SettingsError("no such thing", remedy="Take another")

    task = Task(gpu, Turns(), bad)
    with pytest.raises(SettingsError, match=r"no such thing\. Take another"):
        task.result()
    assert task.is_done


def test_errors_in_words():
    assert said(SettingsError("it is bad", where="here")) == "here: it is bad"
    assert said(ValueError("odd\n  thing")) == "internal error: ValueError: odd thing"


def test_a_turn_inside_a_turn_is_the_same_one():
    turns, order = Turns(), []
    with turns.behind():
        assert turns.is_behind_here
        with turns.behind():
            order.append("inner")
        assert turns.is_behind_here
        other = threading.Thread(target=lambda: order.append(turns.is_behind_here))
        other.start()
        other.join()
    assert order == ["inner", False]
    assert not turns.is_behind_here
