"""What a sequence is asked to be: which frames, when, and how each is made."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from ... import __version__
from ...errors import SettingsError

if TYPE_CHECKING:
    from ...maths.lut import Lut
    from ...scene import Scene

MOST_FRAMES = 1_000_000
FORMATS = {"png": ".png", "exr": ".exr"}


@dataclass(frozen=True)
class Plan:
    """Frames `first`..`last` of a sequence whose frame k shows the scene at start_s + k / fps.

    `exposure_stops` None: the camera's. `ending` is of a frame's file.
    """

    technique: str
    size: tuple[int, int]
    start_s: float
    fps: float
    first: int
    last: int
    settings: Mapping[str, Any] = field(default_factory=dict)
    samples: int = 4
    adapter: str = "auto"
    ending: str = ".png"
    layers: bool = False
    exposure_stops: float | None = None
    tone_map: str | None = None
    lut: Lut | None = None

    @property
    def frames(self) -> range:
        """The frames' numbers."""
        return range(self.first, self.last + 1)

    def time_s(self, frame: int) -> float:
        """When a frame is."""
        return self.start_s + frame / self.fps

    def asked(self, scene: Scene) -> dict[str, Any]:
        """What every frame's pixels depend on; sequences that agree in it may share a folder."""
        from ...scene.fingerprint import fingerprint

        return {
            "airlight": __version__,
            "scene": fingerprint(scene),
            "technique": self.technique,
            "settings": {name: str(value) for name, value in sorted(self.settings.items())},
            "size": list(self.size),
            "samples": self.samples,
            "start_s": self.start_s,
            "fps": self.fps,
            "format": self.ending.removeprefix("."),
            "layers": self.layers,
            "exposure": self.exposure_stops,
            "tone_map": self.tone_map,
            "lut": None if self.lut is None else fingerprint(self.lut),
        }


def digest(asked: Mapping[str, Any]) -> str:
    """16 hexadecimal digits that tell what was asked."""
    text = json.dumps(asked, sort_keys=True)
    return hashlib.blake2b(text.encode(), digest_size=8).hexdigest()


def frame_span(
    scene: Scene, frames: str | None, start_s: float | None, end_s: float | None, fps: float | None
) -> tuple[float, float, int, int]:
    """(start, seconds; frames per second; first and last frame) from options and the animation.

    `frames` is a count, or A-B: these of all. Raises SettingsError, also where nothing moves.
    """
    animation = scene.animation
    if animation is None:
        raise SettingsError(
            f"nothing moves in '{scene.name}'",
            remedy="Add keyframes to its scene file ([[camera.key]] ...) or grids that follow "
            "each other ([[volume]] sequence), or use airlight render.",
        )
    # What the options leave open is the animation's.
    start = animation.start_s if start_s is None else start_s
    end = animation.last_s if end_s is None else end_s
    rate = animation.fps if fps is None else fps
    if end <= start:
        raise SettingsError(f"the end at {end:g} s is not after the start at {start:g} s")
    # A frame at the very end would show a loop's first image twice.
    first, last = 0, max(0, int(-(-(end - start) * rate // 1)) - 1)
    # A product that is whole but for rounding counts as whole.
    exact = (end - start) * rate
    if abs(exact - round(exact)) < 1e-6:
        last = max(0, round(exact) - 1)
    if frames is not None:
        first, last = _parsed(frames, last, has_end=end_s is not None)
    if last >= MOST_FRAMES:
        raise SettingsError(f"{last + 1} frames are too many", remedy=f"At most {MOST_FRAMES}.")
    return start, rate, first, last


def _parsed(text: str, last: int, *, has_end: bool) -> tuple[int, int]:
    """(first, last) of 'N' (the first N) or 'A-B'."""
    found = re.fullmatch(r"(\d{1,9})(?:-(\d{1,9}))?", text.strip())
    if not found:
        raise SettingsError(f"--frames '{text}' is neither a number nor written as A-B")
    # A number N asks for the first N frames.
    if found[2] is None:
        if int(found[1]) < 1:
            raise SettingsError("--frames 0 asks for nothing")
        if has_end:
            raise SettingsError(
                "--frames and --end both say where it ends", remedy="Use one, or --frames A-B."
            )
        return 0, int(found[1]) - 1
    # A range A-B has to lie within what there is.
    first, end = int(found[1]), int(found[2])
    if end < first:
        raise SettingsError(f"--frames {text} runs backwards")
    if has_end and end > last:
        raise SettingsError(f"--frames {text} goes beyond the last frame, {last}")
    return first, end
