"""The scene that is open at a viewer, and what is done with it; without a device."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...display.presenter import Look
from ...errors import AirlightError
from ...scene.environment import Environment
from ...scene.io.doubts import doubts
from ...scene.io.ground import without_ground
from ...scene.io.images import read_radiance
from ...scene.scene import Scene
from .controls import CameraControls
from .free_space import FreeSpace
from .gizmos import Grips
from .history import History
from .source import Source
from .state import ViewState

MAP_SUFFIXES = (".hdr", ".exr", ".png", ".jpg", ".jpeg")


class Document:
    """`state` is what a person has chosen, `controls` their camera, `grips` the lights in their
    hand, `history` what can be undone.
    """

    def __init__(self, source: Source, state: ViewState) -> None:
        scene = source.loaded
        self.source, self.state = source, state
        state.look = first_look(scene)
        self.controls = CameraControls(scene.camera, reach_m(scene), FreeSpace(scene))
        self.grips, self.history = Grips(state), History(state)
        self._doubted: tuple[Any, tuple[str, ...]] = (None, ())

    @property
    def is_held(self) -> bool:
        """Whether a hand has the camera or a light."""
        return self.controls.is_held or self.grips.is_held

    def release(self) -> None:
        """Whoever held something is gone."""
        self.controls.release()
        self.grips.release()

    def has_edit(self) -> bool:
        """Take an edit of the scene file, if there is one; a broken one becomes the message."""
        if self.source.watch is None or not self.source.watch.changed():
            return False
        self.reload()
        return True

    def reload(self) -> None:
        """Load the file again; what was changed here and not in the file stays."""
        try:
            after = self.source.again()
        except AirlightError as error:
            self.state.message = str(error)
            return
        # What a hand changed stays, what the file changed is taken.
        before, self.source.loaded = self.source.loaded, after
        self.state.take(before, after)
        self.controls.free = FreeSpace(after)
        if after.camera != before.camera:
            self.controls.camera = self.controls.home = after.camera

    def open(self, name: str) -> None:
        """Show another scene, by its path or builtin:NAME; what goes wrong becomes the message."""
        try:
            self.source = self.source.opened(name)
        except AirlightError as error:
            self.state.message = str(error)
            return
        # Another scene has another camera, and nothing to undo.
        scene = self.source.loaded
        self.state.begin(scene, first_look(scene))
        self.controls = CameraControls(scene.camera, reach_m(scene), FreeSpace(scene))
        self.history = History(self.state)

    def read_as(self, **model: Any) -> None:
        """Read the file again with other options, as which axis is up; what was changed here and is
        not of the file stays. What goes wrong becomes the message."""
        before, state = self.source.loaded, self.state
        try:
            self.source = self.source.read_as(**model)
        except AirlightError as error:
            state.message = str(error)
            return
        # Everything lies elsewhere: the camera is the file's again, and nothing can be undone.
        scene = self.source.loaded
        state.take(before, scene)
        state.notice, state.look = "", replace(state.look, reach_m=reach_m(scene) / 4.0)
        self.controls = CameraControls(scene.camera, reach_m(scene), FreeSpace(scene))
        self.history = History(state)

    def drop(self, name: str, *, stays: bool = True) -> None:
        """Open a file that a person brought: a map becomes the environment, else it is a scene.

        `stays`: the file will be there when the viewer is gone, so that scene files may name it.
        """
        path = Path(name)
        if path.suffix.lower() not in MAP_SUFFIXES:
            self.open(name)
            return
        # A map lights the scene that is open.
        try:
            light = read_radiance(path)
            self.state.put_environment(
                Environment(map=light, source=str(path.resolve()) if stays else "")
            )
        except AirlightError as error:
            self.state.message = str(error)

    def undo(self) -> None:
        """Take the last change back."""
        self.history.undo(self.state)

    def redo(self) -> None:
        """What was taken back last, again."""
        self.history.redo(self.state)

    def scene_now(self) -> Scene:
        """The scene with the camera and exposure of this moment."""
        stops = self.state.look.exposure_stops
        scene = self.state.moved()
        return replace(scene, camera=replace(self.controls.camera, exposure_stops=stops))

    @property
    def doubts(self) -> tuple[str, ...]:
        """What of the air is hardly meant; looked for when the air has changed and a hand rests."""
        scene = self.state.scene
        # Looking for doubts casts rays, so it waits until a hand rests.
        key = (scene.medium, id(scene.meshes))
        if key != self._doubted[0] and not self.is_held:
            self._doubted = key, doubts(self.scene_now())
        return self._doubted[1]


def first_look(scene: Scene) -> Look:
    """How a scene that was opened is looked at."""
    return Look(exposure_stops=scene.camera.exposure_stops, reach_m=reach_m(scene) / 4.0)


def reach_m(scene: Scene) -> float:
    """The diagonal of what is to be seen, metres."""
    low, high = without_ground(scene).bounds
    return float(np.linalg.norm(high - low)) or 1.0
