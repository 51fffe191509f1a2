"""A value inside a glTF document that knows where it stands, so that every error can say it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ...errors import SceneError
from .. import checks


class Item:
    """A JSON value at `place` (such as accessors[3].count) of `file`.

    Every reading method raises SceneError naming both for a value that is missing or wrong.
    """

    def __init__(self, value: Any, place: str, file: Path) -> None:
        self.value = value
        self.place = place
        self.file = file

    def error(self, problem: str, remedy: str = "") -> SceneError:
        """The error that something is wrong with this value."""
        return SceneError(f"{self.place}: {problem}", where=self.file, remedy=remedy)

    def has(self, key: str) -> bool:
        """Whether this object holds `key`."""
        return isinstance(self.value, dict) and self.value.get(key) is not None

    def keys(self) -> list[str]:
        """The names in this object."""
        if not isinstance(self.value, dict):
            raise self.error(f"must be an object, not {_shown(self.value)}")
        return list(self.value)

    def child(self, key: str) -> Item:
        """The value under `key`; an empty object where there is none."""
        place = f"{self.place}.{key}" if self.place else key
        if not isinstance(self.value, dict):
            raise self.error(f"must be an object, not {_shown(self.value)}")
        value = self.value.get(key)
        return Item({} if value is None else value, place, self.file)

    def at(self, *keys: str) -> Item:
        """The value under a chain of keys, empty where the chain breaks."""
        item = self
        for key in keys:
            item = item.child(key)
        return item

    def items(self, key: str) -> list[Item]:
        """The elements of the list under `key`; none where it is absent."""
        if not self.has(key):
            return []
        listed = self.child(key)
        if not isinstance(listed.value, list):
            raise listed.error(f"must be a list, not {_shown(listed.value)}")
        return [
            Item(value, f"{listed.place}[{k}]", self.file) for k, value in enumerate(listed.value)
        ]

    def whole(self, *, low: int = 0) -> int:
        """This value as a whole number of at least `low`."""
        value = self._number()
        if value != int(value):
            raise self.error(f"must be a whole number, not {_shown(self.value)}")
        if value < low:
            raise self.error(f"is {int(value)}, below {low}")
        return int(value)

    def pick(self, targets: Sequence[Any], what: str) -> int:
        """This value as the number of one of `targets`, which a message calls `what`."""
        k = self.whole()
        if k >= len(targets):
            raise self.error(f"is {k}, but the file has {len(targets)} {what}")
        return k

    def integer(self, key: str, default: int | None = None, *, low: int = 0) -> int:
        """The whole number under `key`."""
        if not self.has(key) and default is not None:
            return default
        return self._present(key).whole(low=low)

    def number(self, key: str, default: float) -> float:
        """A finite number."""
        return self.floats(key, 1, (default,))[0]

    def floats(self, key: str, count: int, default: Sequence[float]) -> tuple[float, ...]:
        """`count` finite numbers."""
        if not self.has(key):
            return tuple(default)
        child = self.child(key)
        # A single number counts as a list of one.
        values = child.value if isinstance(child.value, list) else [child.value]
        try:
            numbers = tuple(checks.number(value, key) for value in values)
        except SceneError:
            numbers = ()
        if len(numbers) != count:
            raise child.error(f"must be {count} finite numbers, not {_shown(child.value)}")
        return numbers

    def text(self, key: str, default: str = "") -> str:
        """A string."""
        if not self.has(key):
            return default
        child = self.child(key)
        if not isinstance(child.value, str):
            raise child.error(f"must be text, not {_shown(child.value)}")
        return child.value

    def flag(self, key: str) -> bool:
        """true, or false where absent."""
        return self.has(key) and self.value[key] is True

    def index(self, key: str, targets: Sequence[Any], what: str) -> int:
        """The number under `key`, which picks one of `targets`."""
        return self._present(key).pick(targets, what)

    def _number(self) -> float:
        """This value as a finite number."""
        try:
            return checks.number(self.value, self.place)
        except SceneError:
            raise self.error(f"must be a whole number, not {_shown(self.value)}") from None

    def _present(self, key: str) -> Item:
        if not self.has(key):
            raise self.error(f"has no '{key}'")
        return self.child(key)


def _shown(value: Any) -> str:
    text = checks.shown(value)
    return text if len(text) <= 40 else text[:37] + "..."
