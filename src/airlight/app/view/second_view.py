"""Another view of what a renderer has solved: no light is solved twice."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import ExitStack
from typing import Any

from ...gpu.commands import Commands
from ...lighting.view import View
from ...rendering import Renderer
from ...sampled_view import SampledView
from ...scene.nearby import Nearby
from ...scene.scene import Scene
from ...techniques.beside import OF_VIEWS, Beside


def can_show(first: Renderer, changes: Mapping[str, Any]) -> bool:
    """Whether an image with other settings, `changes`, is one of what `first` has solved."""
    return first.technique.views is not None and OF_VIEWS.issuperset(changes)


class SecondView(Renderer):
    """A renderer of images of the scene that `first` shows, which solves it for both.

    Its size and its settings `OF_VIEWS` are its own. `first` may be closed before it: what both
    need stays until both are.
    """

    def __init__(self, first: Renderer, size: tuple[int, int], changes: Mapping[str, Any]) -> None:
        """`changes`: as `can_show` allows."""
        self._first, self._changes = first, changes
        super().__init__(first.scene, first.technique.name, size, adapter=first._wanted[2])

    def _create(self, made: ExitStack) -> None:
        first, gpu = self._first, self.gpu
        made.callback(first._lend())
        self.commands = Commands(gpu)
        self.meshes, self.made_for = first.meshes, first.made_for
        self._nearby = Nearby(first.origin)
        self.technique = Beside(first.technique, gpu, self.size, self._changes)
        made.callback(self.technique.release)
        self.view = View(gpu, self.size)
        self._sampled = SampledView(self.view, self.technique, self.commands, self._nearby)

    def show(self, scene: Scene) -> Scene:
        """Make `scene` the one that is shown, as `first` shows it: meshes have moved for both."""
        self.scene = scene
        return scene
