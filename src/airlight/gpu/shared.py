"""What parts of a technique share that do not know one another."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Any, TypeVar

Made = TypeVar("Made")


class Shared:
    """Things by key, each made by the first part that asks for it; kept as long as this is."""

    def __init__(self) -> None:
        self._made: dict[Hashable, Any] = {}

    def once(self, key: Hashable, make: Callable[[], Made]) -> Made:
        """What `make` made for `key`, or makes now."""
        if key not in self._made:
            self._made[key] = make()
        made: Made = self._made[key]
        return made
