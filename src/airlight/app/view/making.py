"""Another renderer for the viewer, created in the background while the current one draws."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ...gpu.device import Gpu
from ...gpu.sliced import SlicedCommands
from ...rendering import Renderer
from .build import Task, Turns
from .drawn import Drawn

Structure = tuple[Any, ...]

PREVIEW = ("preview",)
"""The structure of what is seen until the technique's first image is there."""
PREVIEW_TECHNIQUE = "direct"
PREVIEW_SETTINGS = {
    "ambient_occlusion": False,
    "shadow_resolution": 256,
    "sky_lights": 6,
    "resolution": 8,
    "area_samples": 4,
}
"""Living room, CPU adapter: 4.9 s of processor time from scene to image; 9 with `lpv`."""


class BackgroundRenderer(Renderer):
    """One that leaves the device to others until it is asked for a solution, pass by pass."""

    _submits_at_once = False


class Making:
    """At most one renderer at a time; one that nobody wants any more is broken off."""

    def __init__(self, gpu: Gpu, turns: Turns) -> None:
        self.gpu, self._turns = gpu, turns
        self.wanted: Structure | None = None
        self._task: Task[Drawn] | None = None
        self._ending: list[Task[Drawn]] = []

    @property
    def is_under_way(self) -> bool:
        """Whether one is being created, or is ready and has not been taken."""
        return self._task is not None

    @property
    def progress(self) -> str:
        """Which stage it is in, and for how long it has been made; empty where nothing is."""
        return self._task.progress if self._task else ""

    @property
    def has_ended(self) -> bool:
        """Whether there is something to take."""
        return self._task is not None and self._task.is_done

    def begin(self, structure: Structure, make: Callable[[], Renderer]) -> None:
        """Create a renderer of `structure`, and draw its first image, unless that is under way."""
        if self._task and self.wanted == structure:
            return
        self.give_up()
        # What ended is closed; while something still ends, nothing new begins.
        for task in self._ending:
            if not task.is_done:  # memory for one of them at a time
                return
            _close(task)
        self._ending.clear()
        self.wanted = structure
        self._task = Task(self.gpu, self._turns, lambda commands: _warm(commands, make))

    def give_up(self) -> None:
        """Stop what is being created, because nobody needs it any more."""
        if self._task:
            self._task.stop()
            self._ending.append(self._task)
        self._task = self.wanted = None

    def take(self) -> tuple[Structure, Drawn]:
        """What was made, waiting for it. Raises what making it raised."""
        assert self._task and self.wanted
        task, wanted, self._task, self.wanted = self._task, self.wanted, None, None
        drawn = task.result()
        assert drawn is not None
        return wanted, drawn

    def close(self) -> None:
        """Break off what is being made, and wait for that."""
        self.give_up()
        for task in self._ending:
            task.wait()
            _close(task)
        self._ending.clear()


def _warm(commands: SlicedCommands, make: Callable[[], Renderer]) -> Drawn:
    """A renderer with its scene solved and one image drawn, so that its next one is quick."""
    drawn = Drawn(make())
    try:
        # Its first image compiles what its next ones need.
        drawn.solve(commands)
        drawn.draw(commands, drawn.renderer.scene.camera, (0.0, 0.0), 0)
        commands.submit()
    except BaseException:
        drawn.close()
        raise
    return drawn


def _close(task: Task[Drawn]) -> None:
    """What a task made before it could be stopped."""
    try:
        made = task.result()
    except Exception:
        return
    if made:
        made.close()
