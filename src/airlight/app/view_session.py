"""A scene being looked at: takes changes, draws the next picture, keeps the last good one.

It knows no window: `app.view_canvas` puts it on one. Nothing is read back from the device,
except a picture to be saved.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ..display.presenter import Look, Presenter, layer_names
from ..errors import AirlightError
from ..gpu.device import open_gpu
from ..maths.sampling import pixel_jitter
from ..rendering import Renderer
from ..scene.camera import Camera
from ..scene.image import Image
from ..scene.io import BUILTIN_PREFIX, load
from ..scene.scene import Scene
from ..techniques import technique_class
from .view_controls import CameraControls
from .view_quality import STILL_SAMPLES, Plan, Quality
from .view_state import ViewState, reloaded, structure
from .view_watch import Watch

_SAVED_SAMPLES = 16
_HAND_S = 0.25
PREPARING = "preparing ..."


class Session:
    """`attach` it to a surface's format, then `frame` again and again.

    Raises SettingsError for an unknown technique, DeviceError without a device; later errors
    become `state.message`.
    """

    def __init__(
        self, scene: Scene, *, source: str = "", technique: str = "auto",
        settings: Mapping[str, Any] | None = None, adapter: str = "auto",
    ) -> None:  # fmt: skip
        technique_class(technique)
        self.gpu = open_gpu(adapter)
        self.source, self.loaded, self._adapter = source, scene, adapter
        look = Look(exposure_stops=scene.camera.exposure_stops, reach_m=reach_m(scene) / 4.0)
        own = {technique: dict(settings)} if settings else {}
        self.state = ViewState(scene, technique, own, look)
        self.controls = CameraControls(scene.camera, reach_m(scene))
        self.quality = Quality(is_cpu=self.gpu.is_cpu)
        self.renderer: Renderer | None = None
        self.frame_ms, self.times_ms = 0.0, dict[str, float]()
        is_file = bool(source) and not source.startswith(BUILTIN_PREFIX)
        self._watch = Watch(Path(source)) if is_file else None
        self._presenter: Presenter | None = None
        self._format = ""
        self._size = (1, 1)
        self._camera, self._time_s = scene.camera, 0.0
        self._jitters = pixel_jitter(STILL_SAMPLES)
        self._announced: tuple[Any, ...] | None = None
        self._refused: tuple[Any, ...] | None = None
        self._made: tuple[Any, ...] | None = None
        self._drawn: tuple[Any, ...] = ()
        self._solved: tuple[Any, ...] = ()
        self._toned: Look | None = None
        self._before_s: float | None = None
        self._touched_s = float("-inf")
        self._solve_ms = 0.0

    def attach(self, format: str) -> None:
        """The surface's textures have this format."""
        if format != self._format:
            self._format = format
            if self._presenter:
                self._presenter.release()
            self._presenter = None

    def touch(self, now_s: float) -> None:
        """A hand is at the mouse or the keys: fine pictures wait a moment."""
        self._touched_s = now_s

    @property
    def layers(self) -> tuple[str, ...]:
        """What can be looked at."""
        if self.renderer is None:
            return ("picture",)
        return layer_names(self.renderer.technique.pictures(self.renderer.view))

    def has_edit(self) -> bool:
        """Take an edit of the scene file, if there is one; a broken one becomes the message."""
        if self._watch is None or not self._watch.changed():
            return False
        self.reload()
        return True

    def reload(self) -> None:
        """Load the file again; what was changed here and not in the file stays."""
        try:
            after = load(self.source)
        except AirlightError as error:
            self.state.message = str(error)
            return
        state, before = self.state, self.loaded
        state.scene, self.loaded = reloaded(state.scene, before, after), after
        state.message, state.notice = "", "the scene file was read again"
        if after.camera != before.camera:
            self.controls.camera = self.controls.home = after.camera
            state.look = replace(state.look, exposure_stops=after.camera.exposure_stops)

    def frame(self, target: Any, size: tuple[int, int], now_s: float) -> bool:
        """Draw onto `target`, a surface of `size` pixels; true where more frames are wanted."""
        self._size = size
        if self._announces():
            self._show(target)
            return True
        self.controls.height_px = size[1]
        self._go_on(now_s)
        self.state.turn_light(self.controls.take_turn())
        is_busy = self.controls.is_held or now_s - self._touched_s < _HAND_S
        plan = self.quality.plan(now_s, size, changed=self._has_changed(), is_busy=is_busy)
        if plan.sample is not None:
            self._draw_or_say(plan)
        elif self._presenter and self._toned not in (None, self.state.look):
            self._tone(settled=True)
        self._show(target)
        is_unfinished = self.quality.share < 1.0 and self._presenter is not None
        return plan.is_moving or plan.sample is not None or is_unfinished

    def _go_on(self, now_s: float) -> None:
        """What moves by itself: the camera by held keys, the scene by its time."""
        spent_s = 0.0 if self._before_s is None else now_s - self._before_s
        self.controls.advance(spent_s)
        state = self.state
        state.play(spent_s)
        goes_on = self.controls.is_moving or state.is_playing
        self._before_s = now_s if goes_on else None
        if state.time_s != self._time_s:
            self._time_s, before = state.time_s, self._camera
            self._camera = state.moved().camera
            if self._camera != before:  # the scene moves its camera; a hand may take it from there
                self.controls.camera = self._camera

    def frame_size(self, size: tuple[int, int]) -> None:
        """The size of pictures until a frame says another."""
        self._size = size

    def picture(self, samples: int = _SAVED_SAMPLES) -> Image:
        """What is seen now, at full size, with its layers. Raises AirlightError."""
        self._make_renderer(self._size)
        assert self.renderer is not None
        self.renderer.resize(self._size)
        self._give_scene(self.renderer)
        image = self.renderer.frame(samples=samples)
        assert image is not None
        self._drawn = ()
        return replace(image, tone_map=self.state.look.curve)

    def scene_now(self) -> Scene:
        """The scene with the camera and exposure of this moment."""
        stops = self.state.look.exposure_stops
        scene = self.state.moved()
        return replace(scene, camera=replace(self.controls.camera, exposure_stops=stops))

    def close(self) -> None:
        """Give the device's memory back."""
        for part in (self._presenter,):
            if part:
                part.release()
        if self.renderer:
            self.renderer.close()
        self.renderer = self._presenter = None

    def _announces(self) -> bool:
        """Whether this frame only says that the next one takes long: it makes a renderer."""
        wanted = structure(self.state)
        if wanted in (self._made, self._refused, self._announced):
            return False
        self._announced, self.state.notice = wanted, PREPARING
        return True

    def _has_changed(self) -> bool:
        s = self.state
        now = (self.controls.camera, s.scene, structure(s), s.look.layer, s.shows_times, s.time_s)
        if _is_same(now, self._drawn):
            return False
        self._drawn = now
        return True

    def _draw_or_say(self, plan: Plan) -> None:
        begin, self._solve_ms = time.perf_counter(), 0.0
        made = self._made
        try:
            self._make_renderer(plan.size)
            self._draw(plan)
        except AirlightError as error:
            self.state.message, self.state.notice = str(error), ""
        except Exception as error:  # a driver's refusal must not take the window down
            text = " ".join(str(error).split())[:400]
            self.state.message = f"internal error: {type(error).__name__}: {text}"
        self.frame_ms = (time.perf_counter() - begin) * 1e3
        if self._made == made:  # making is no frame
            # Solving costs the same at every resolution.
            self.quality.took(self.frame_ms - self._solve_ms, plan)

    def _make_renderer(self, size: tuple[int, int]) -> None:
        """A renderer for the state's structure; where it is refused, the one before stays."""
        wanted = structure(self.state)
        if wanted in (self._made, self._refused):
            return
        self._refused, self._announced = wanted, None
        state = self.state
        made = Renderer(
            self.scene_now(), state.technique, size, settings=state.chosen_settings,
            adapter=self._adapter,
        )  # fmt: skip
        if self.renderer:
            self.renderer.close()
        self.renderer, self._made, self._refused = made, wanted, None
        self._solved, state.message = (), ""
        state.notice = "" if state.notice == PREPARING else state.notice

    def _draw(self, plan: Plan) -> None:
        r = self.renderer
        if r is None or plan.sample is None:
            return
        r.resize(plan.size)
        commands = r.commands
        commands.is_timed, commands.stage_ms = self.state.shows_times, {}
        if self._made == structure(self.state):
            self._give_scene(r)
        self._solve(r)
        jitter = (0.0, 0.0) if plan.is_moving else tuple(self._jitters[plan.sample])
        r.view.aim(self.controls.camera, jitter, plan.sample)
        r.technique.draw(commands, r.view)
        self._presented(r, plan)
        self._tone(settled=not plan.is_moving)
        r.gpu.wait()
        if commands.is_timed:
            if not r.gpu.is_cpu:
                commands.collect_timestamps()
            self.times_ms = dict(commands.stage_ms)
        commands.is_timed = False

    def _give_scene(self, r: Renderer) -> None:
        scene = self.scene_now()
        if scene.meshes is not r.scene.meshes:
            r.meshes.move(scene.meshes)
        r.scene = scene

    def _solve(self, r: Renderer) -> None:
        """All that the camera does not matter for, unless nothing else has changed."""
        scene = r.scene
        parts = (scene.lights, scene.light_groups, scene.medium, scene.volumes,
                 scene.environment, scene.meshes)  # fmt: skip
        # Fog without bounds reaches to the camera where that stands outside the scene.
        fog = scene.medium
        place = scene.camera.position if fog is not None and fog.bounds is None else None
        if place is not None:
            low, high = scene.bounds
            place = None if np.all(place >= low) and np.all(place <= high) else place
        now = (*parts, place)
        if _is_same(now, self._solved):
            return
        begin = time.perf_counter()
        r.technique.solve(r.commands, scene)
        self._solved = now
        if r.gpu.is_cpu:
            r.commands.submit()
            r.gpu.wait()
            self._solve_ms = (time.perf_counter() - begin) * 1e3

    def _presented(self, r: Renderer, plan: Plan) -> None:
        if self._presenter is None:
            self._presenter = Presenter(r.gpu, plan.size, self._format)
        self._presenter.resize(plan.size)
        pictures = r.technique.pictures(r.view)
        self._presenter.take(r.commands, pictures, r.view, self.state.look, plan.sample or 0)

    def _tone(self, *, settled: bool) -> None:
        assert self._presenter and self.renderer
        self._presenter.tone(self.renderer.commands, self.state.look, settled=settled)
        self.renderer.commands.submit()
        self._toned = self.state.look

    def _show(self, target: Any) -> None:
        if self._presenter and self.renderer:
            self._presenter.show(self.renderer.commands, target)
            self.renderer.commands.submit()


def _is_same(now: tuple[Any, ...], before: tuple[Any, ...]) -> bool:
    """Whether nothing changed; scenes and their parts are compared by identity, they are frozen."""
    plain = (str, bool, float, tuple, Camera)
    return len(now) == len(before) and all(
        a is b or (isinstance(a, plain) and a == b) for a, b in zip(now, before, strict=True)
    )


def reach_m(scene: Scene) -> float:
    """The diagonal of what is to be seen, metres."""
    low, high = scene.bounds
    return float(np.linalg.norm(high - low)) or 1.0
