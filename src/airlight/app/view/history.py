"""Undo and redo: what a person chose, as it was whenever a hand came to rest."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from ...display.presenter import Look
from ...scene.scene import Scene
from .slices import Sliced
from .state import ViewState

_MOST = 200


@dataclass(frozen=True, eq=False)
class Kept:
    """What is undone; scenes and their parts are frozen, so that keeping them costs nothing."""

    scene: Scene
    technique: str
    settings: dict[str, dict[str, Any]]
    look: Look
    light: int
    sliced: dict[int, Sliced]

    @classmethod
    def of(cls, state: ViewState) -> Kept:
        """The state's part that is kept."""
        s = state
        # Dictionaries are copied, as the state goes on changing its own.
        settings = {name: dict(own) for name, own in s.settings.items() if own}
        return cls(s.scene, s.technique, settings, s.look, s.light, s.sliced)

    def put(self, state: ViewState) -> None:
        """The state as it was."""
        state.scene, state.technique, state.look = self.scene, self.technique, self.look
        state.settings = {name: dict(own) for name, own in self.settings.items()}
        state.light, state.sliced = self.light, self.sliced

    def is_as(self, other: Kept) -> bool:
        """Whether undoing one for the other would change anything; which light is chosen is not."""
        own = (self.technique, self.settings, self.look)
        return self.scene is other.scene and own == (other.technique, other.settings, other.look)


class History:
    """`note` whenever a hand rests; `undo` and `redo` go between what was noted."""

    def __init__(self, state: ViewState) -> None:
        self._kept, self._at = [Kept.of(state)], 0

    @property
    def can_undo(self) -> bool:
        """Whether something was changed that can be taken back."""
        return self._at > 0

    @property
    def can_redo(self) -> bool:
        """Whether something was taken back."""
        return self._at + 1 < len(self._kept)

    def note(self, state: ViewState) -> None:
        """Remember the state, where it is another one than the last."""
        now = Kept.of(state)
        # Choosing a light is no change by itself, and goes with the one before.
        if now.is_as(self._kept[self._at]):
            self._kept[self._at] = replace(self._kept[self._at], light=now.light)
            return
        # A new change ends what could have been done again.
        self._kept = [*self._kept[: self._at + 1], now][-_MOST:]
        self._at = len(self._kept) - 1

    def undo(self, state: ViewState) -> None:
        """One change back, where there is one."""
        self.note(state)
        self._go(state, -1 if self.can_undo else 0)

    def redo(self, state: ViewState) -> None:
        """What was taken back last, again."""
        self._go(state, 1 if self.can_redo else 0)

    def _go(self, state: ViewState, by: int) -> None:
        if by:
            self._at += by
            self._kept[self._at].put(state)
