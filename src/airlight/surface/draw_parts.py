"""What a pass derives from a view's list of draws, cached for each list.

Passes identify lists of draws by identity, and replay what they recorded for a list.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

from .draws import MOST_CACHED_VIEWS, Draw
from .geometry import GpuScene

Parts = TypeVar("Parts")


def in_draw_order(scene: GpuScene, draws: list[Draw]) -> list[Draw]:
    """`draws` in the order in which every device draws them.

    Of coincident surfaces the last one is visible. CPU adapters draw some materials in a second
    pass (see `GpuScene.is_drawn_last`); on GPUs these come last, too.
    """
    # A stable partition: the order within either part stays.
    is_late = [scene.is_drawn_last(draw) for draw in draws]
    if not any(is_late) or all(is_late):
        return draws
    late = [draw for draw, late in zip(draws, is_late, strict=True) if late]
    return [draw for draw, late in zip(draws, is_late, strict=True) if not late] + late


class DrawParts(Generic[Parts]):
    """`make` of each list that `GpuScene.visible` returns, cached until that returns another."""

    def __init__(self, make: Callable[[GpuScene, list[Draw]], Parts]) -> None:
        self._make = make
        self._scene: GpuScene | None = None
        self._state = (0, 0)
        # The lists are stored, too, so that no other list gets their ids.
        self._cached: dict[int, tuple[list[Draw], Parts]] = {}

    def of(self, scene: GpuScene, draws: list[Draw]) -> Parts:
        """`make(scene, draws)`."""
        self._forget(scene)
        found = self._cached.get(id(draws))
        if found is None:
            if len(self._cached) >= MOST_CACHED_VIEWS:
                self._cached.pop(next(iter(self._cached)))
            found = self._cached[id(draws)] = (draws, self._make(scene, draws))
        return found[1]

    def _forget(self, scene: GpuScene) -> None:
        """Drop the results for another scene, and for lists from before something moved."""
        state = (scene.version, scene.extra_changes)
        if scene is self._scene and state == self._state:
            return

        # The list of everything outlives moves, because it holds the same draws in the same order.
        whole = self._cached.get(id(scene.draws))
        self._cached.clear()
        if whole and scene is self._scene and state[1] == self._state[1]:
            self._cached[id(scene.draws)] = whole
        self._scene, self._state = scene, state
