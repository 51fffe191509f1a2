"""What parts share is made once."""

from __future__ import annotations

from airlight.gpu.shared import Shared


def test_the_first_that_asks_makes_it() -> None:
    shared, made = Shared(), []

    def make(name: str) -> list[str]:
        made.append(name)
        return [name]

    first = shared.once("key", lambda: make("first"))
    assert shared.once("key", lambda: make("second")) is first
    assert shared.once("other", lambda: make("third")) == ["third"]
    assert made == ["first", "third"]
