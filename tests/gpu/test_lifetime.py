"""What holds a device: made once, made again when torn, given back when closed or half made."""

from __future__ import annotations

from contextlib import ExitStack

import pytest

from airlight.errors import DeviceError
from airlight.gpu.device import Gpu, open_gpu
from airlight.gpu.lifetime import DeviceLifetime
from airlight.gpu.memory import Buffer


class Held(DeviceLifetime):
    """A buffer on a device; `told` is what became of it, in order."""

    def __init__(self) -> None:
        super().__init__("this holder")
        self.told: list[str] = []
        self.fails = False
        self._make()

    def _open(self) -> Gpu:
        return open_gpu().scope()

    def _create(self, made: ExitStack) -> None:
        self.told.append("made")
        made.callback(lambda: self.told.append("released"))
        self.buffer = Buffer(self.gpu, "held", 1024)
        if self.fails:
            raise ValueError("no more")

    def tear(self) -> None:
        self._is_torn = True


def test_what_was_torn_is_made_again_when_it_is_used() -> None:
    with Held() as held:
        first = held.buffer
        with held.used():
            assert held.buffer is first
        held.tear()
        with held.used():
            assert held.buffer is not first
        assert held.told == ["made", "released", "made"]
    assert held.told[-1] == "released"


def test_a_closed_one_refuses_and_closes_once() -> None:
    held = Held()
    held.close()
    held.close()
    assert held.told == ["made", "released"]
    with pytest.raises(DeviceError, match="this holder is closed"), held.used():
        pass


def test_what_was_half_made_is_given_back_and_tried_again() -> None:
    held = Held()
    held.fails = True
    held.tear()
    with pytest.raises(ValueError, match="no more"), held.used():
        pass
    assert held.told == ["made", "released", "made", "released"]
    held.fails = False
    with held.used():
        assert held.told[-1] == "made"
    held.close()
