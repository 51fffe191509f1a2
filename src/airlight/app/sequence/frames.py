"""Frames of a sequence as images: the same bits in any order, alone or among others."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from .plan import Plan

if TYPE_CHECKING:
    from ...rendering import Renderer
    from ...scene import Scene
    from ...scene.image import Image

_METERED_WIDTH_PX = 160


class FrameMaker:
    """One renderer for all frames. It is made with the scene as it was loaded, at no time.

    What a renderer keeps of the scene it was made with is then the same whatever frame comes first.
    """

    def __init__(self, plan: Plan, scene: Scene) -> None:
        self.plan, self.scene = plan, scene
        self._renderer: Renderer | None = None
        self.doubts: list[str] = []

    @property
    def renderer(self) -> Renderer:
        """Made when first asked for. Raises DeviceError, SettingsError."""
        if self._renderer is None:
            self._renderer = _renderer(self.plan, self.scene, self.plan.size)
            self._renderer.exposure_stops = self.plan.exposure_stops
        return self._renderer

    def image(self, frame: int) -> Image:
        """One frame. Raises SceneError where the scene cannot be at its time."""
        image = self.renderer.frame(time=self.plan.time_s(frame), samples=self.plan.samples)
        assert image is not None
        # The curve and the table of the command, in place of the camera's.
        if self.plan.tone_map is not None:
            image = replace(image, tone_map=self.plan.tone_map)
        return replace(image, lut=self.plan.lut)

    def save(self, frame: int, path: Path) -> None:
        """One frame into a file, whole or not at all. Raises OutputError."""
        # What an image says about its making differs from run to run; frames do not.
        image = self.image(frame)
        self.doubts += [f"frame {frame}: {text}" for text in image.doubts]
        replace(image, stats={}).save(path, layers=self.plan.layers)

    def encoded(self, frame: int) -> bytes:
        """One frame as the bytes of its file."""
        with tempfile.TemporaryDirectory(prefix="airlight-") as folder:
            path = Path(folder) / f"frame{self.plan.ending}"
            self.save(frame, path)
            return path.read_bytes()

    def close(self) -> None:
        """Give the device's memory back."""
        if self._renderer is not None:
            self._renderer.close()


def metered_stops(plan: Plan, scene: Scene) -> float | None:
    """The first frame's exposure for all frames, where the camera leaves it to the image.

    Metered by each frame for itself a sequence would flicker. None where the camera says it.
    """
    if plan.exposure_stops is not None or scene.at(plan.start_s).camera.exposure_stops is not None:
        return None
    # A small image meters as a large one does, at less cost.
    width, height = plan.size
    small = (_METERED_WIDTH_PX, max(1, round(_METERED_WIDTH_PX * height / width)))
    with _renderer(plan, scene, small if width > _METERED_WIDTH_PX else plan.size) as renderer:
        image = renderer.frame(time=plan.start_s)
        assert image is not None
        return float(image.exposure_stops)


def _renderer(plan: Plan, scene: Scene, size: tuple[int, int]) -> Renderer:
    from ...rendering import Renderer

    return Renderer(scene, plan.technique, size, settings=plan.settings, adapter=plan.adapter)
