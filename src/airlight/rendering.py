"""Scene + technique -> image, without a window."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from itertools import repeat
from pathlib import Path
from time import perf_counter
from typing import Any

from .frame_times import FrameTimes
from .gpu.commands import Commands
from .gpu.device import Gpu, open_gpu
from .gpu.lifetime import DeviceLifetime
from .lighting.kit import Context
from .lighting.reach import MadeFor
from .lighting.view import View
from .sampled_view import Progress, SampledView
from .scene.camera import Camera
from .scene.checks import optional_function
from .scene.environment import Environment
from .scene.image import Image, checked_samples, checked_size
from .scene.io import load
from .scene.lens import has_moments, shutter_time, still_samples
from .scene.lights import Light
from .scene.limits import check_extent
from .scene.mesh import Mesh
from .scene.nearby import Nearby, origin_near
from .scene.point_lights import PointLights
from .scene.scene import Scene
from .scene.settings import given_settings
from .scene.shown import ShownScenes, changed, has_unlit, shutter_moments
from .scene.volume import Volume
from .surface.geometry import GpuScene
from .techniques import make_technique


class Renderer(DeviceLifetime):
    """Keeps a scene on the device, for animation and for viewers.

    with Renderer(scene, technique="lpv", size=(640, 360)) as r:
        image = r.frame(camera=...)

    The number and kinds of lights, the meshes' triangles and the number of volumes are fixed;
    everything that `frame` takes may change from call to call (a volume's grid of another size or
    box has what is on the device made again). An image depends on the scene that
    the renderer was made with and on the scene it shows, not on the images before it, unless the
    setting gather_history asks for that. A path or builtin:NAME is loaded. Settings as of `render`.
    Raises SceneError, SettingsError, DeviceError.

    Each thread may have renderers of its own; one renderer serves one thread at a time, any
    thread, and not a forked process: else DeviceError. A frame that an error or Ctrl-C interrupts
    changes nothing: the next one recreates what it needs.
    """

    _submits_at_once = True  # work of the device that can be done while the host makes the rest

    def __init__(
        self,
        scene: Scene | str | Path,
        technique: str = "auto",
        size: tuple[int, int] | None = None,
        *,
        settings: Mapping[str, Any] | None = None,
        adapter: str = "auto",
    ) -> None:
        super().__init__("this Renderer")
        self._times = FrameTimes()
        self.frame_ms, self.python_ms = self._times.frame_ms, self._times.python_ms
        # What the renderer is made for.
        self.scene = scene if isinstance(scene, Scene) else load(scene)
        self.made_for = MadeFor(self.scene)
        self.size = checked_size(self.scene.camera.image_size if size is None else size)
        check_extent(self.scene)
        # Scenes as the device has them: with lights' meshes, from an origin near everything.
        self._shown, self._nearby = ShownScenes(), Nearby(origin_near(self.scene))
        self._wanted = (technique, given_settings(settings), adapter)
        self.exposure_stops: float | None = None
        """Instead of the camera's, where it is a number."""
        self._make()

    def _open(self) -> Gpu:
        # All that the renderer makes is given back with a scope of its own.
        gpu = open_gpu(self._wanted[2]).scope()
        gpu.require("max-texture-dimension-2d", max(self.size), "the image")
        gpu.memory.forget_peak()
        return gpu

    def _create(self, made: ExitStack) -> None:
        """Create all that is on the device."""
        gpu, (technique, settings, _) = self.gpu, self._wanted
        self.commands = Commands(gpu)
        # Positions from that origin, where 32-bit floats are exact enough.
        scene = self._nearby.of(self._shown.of(self.made_for.scene))
        self.meshes = GpuScene(gpu, scene)
        at_once = self.commands if self._submits_at_once else None
        context = Context(gpu, scene, self.meshes, self.size, at_once)
        # The technique says whether its lattices go by what cameras see.
        self.technique = make_technique(context, technique, settings, nearby=self._nearby)
        made.callback(self.technique.release)
        self.made_for = self.made_for.following(self.technique.follows_eye)
        self.view = View(gpu, self.size)
        self._sampled = SampledView(self.view, self.technique, self.commands, self._nearby)

    def frame(
        self,
        *,
        time: float | None = None,
        camera: Camera | None = None,
        lights: Sequence[Light] | None = None,
        environment: Environment | None = None,
        meshes: Sequence[Mesh] | None = None,
        volumes: Sequence[Volume] | None = None,
        light_groups: Sequence[PointLights] | None = None,
        samples: int = 1,
        read: bool = True,
        progress: Progress | None = None,
    ) -> Image | None:
        """One image. What the arguments change stays changed for the frames after it.

        `time`, seconds, evaluates the scene's animation; other arguments override it. `samples`
        jittered images are averaged. `lights`, `environment`, `meshes`, `volumes` and
        `light_groups` take the place of the scene's, as many as there were. Without `read` nothing
        comes back to the host, as in a viewer; the call then returns None when the device is done.
        While the camera's shutter is open samples see what moves at times of their own. Raises
        SceneError, SettingsError, DeviceError.
        """
        begin = perf_counter()
        samples = _checked(samples, progress)
        with self.used():
            before = self.scene
            changes = dict[str, Any](camera=camera, lights=lights, environment=environment)
            changes |= dict(meshes=meshes, volumes=volumes, light_groups=light_groups)
            changes["exposure_stops"] = self.exposure_stops
            scene = changed(before if time is None else before.at(time), **changes)
            # While the shutter is open each sample has a moment of its own.
            moments: Iterator[Scene] | None = None
            if time is not None and samples > 1 and has_moments(scene):
                scene, moments = shutter_moments(before, scene, time, samples, changes)
            if (made_for := self.made_for.showing(scene)) is not self.made_for:
                self.made_for = made_for
                self._remake()
            with self.whole():
                # Light transport, independent of the view; then the view, once per sample.
                if moments is None or has_unlit(scene):
                    self.technique.solve(self.commands, self.show(scene), is_still=samples > 1)
                is_metered = read and has_unlit(scene)
                self.view.metered_stops = self._sampled.metered(scene) if is_metered else 0.0
                scenes = repeat(scene) if moments is None else self._solved(moments)
                self._sampled.draw(scenes, samples, progress)
                if moments is not None:
                    self.show(scene)
                encoded = perf_counter()
                self.gpu.wait()
                self._times.add(begin, encoded, perf_counter())
                if not read:
                    return None
                image = self._sampled.image(scene, samples)
                return dataclasses.replace(image, stats=self.stats())

    def _solved(self, moments: Iterator[Scene]) -> Iterator[Scene]:
        """Each of the `moments`, shown and solved."""
        for scene in moments:
            self.technique.solve(self.commands, self.show(scene), is_still=True)
            yield scene

    @property
    def origin(self) -> tuple[float, float, float]:
        """The place in the world, metres, that is the origin of all positions on the device."""
        return self._nearby.origin

    def show(self, scene: Scene) -> Scene:
        """Make `scene` the one that is shown.

        Returns it as the device has it: with its lights' meshes, volumes in parts, from `origin`.
        """
        shown = self._nearby.of(self._shown.of(scene))
        # Meshes that moved do so on the device.
        if shown.meshes is not self.meshes.current:
            self.meshes.move(shown.meshes)
        self.scene = scene
        return shown

    def aim(
        self,
        camera: Camera,
        jitter_px: tuple[float, float],
        sample: int,
        jitter: tuple[int, int] = (0, 1),
    ) -> None:
        """Look through `camera`, (x, y) `jitter_px` off pixels' middles: `jitter` of a `sample`."""
        self.view.aim(self._nearby.camera(camera), jitter_px, sample, jitter)

    def resize(self, size: tuple[int, int]) -> None:
        """Draw images of `size`, pixels, from here on; the solved fields stay.

        Raises SettingsError, DeviceError.
        """
        size = checked_size(size)
        with self.used():
            if size == self.size:
                return
            # What the device cannot do is refused before anything is changed.
            self.gpu.require("max-texture-dimension-2d", max(size), "the image")
            with self.whole():
                self.size = size
                self._sampled.resize(size)

    def timed_passes(self) -> dict[str, float]:
        """Milliseconds per stage of one more frame, each stage waited for. Raises DeviceError."""
        with self.used():
            commands = self.commands
            # Stages that are waited for take longer: the frame's own times are taken out again.
            commands.is_timed, commands.stage_ms = True, {}
            try:
                self.frame(read=False)
                self._times.forget_last()
                if not self.gpu.is_cpu:
                    commands.collect_timestamps()
            finally:
                commands.is_timed = False
            return dict(commands.stage_ms)

    def stats(self) -> dict[str, Any]:
        """The values of --stats that the renderer knows.

        `frame_ms` and `python_ms` are medians of the frames after the first, which compiles
        shaders; None before there is a second. `first_image_s` counts from the renderer's creation.
        Raises DeviceError where it is closed.
        """
        self._check_open()
        return {
            "device": self.gpu.info.name,
            "adapter_type": self.gpu.info.adapter_type,
            "paths": self.gpu.paths.name,
            **self._times.stats,
            "peak_gpu_bytes": self.gpu.peak_bytes,
            "size": list(self.size),
            "triangles": self.scene.triangle_count,
            **self.technique.stats,
        }

    @contextmanager
    def whole(self) -> Iterator[None]:
        """A context whose work, if interrupted, leaves no trace: `used` recreates all next time."""
        scene, size = self.scene, self.size
        try:
            yield
        except BaseException:
            self.scene, self.size, self._is_torn = scene, size, True
            raise


def _checked(samples: int, progress: Progress | None) -> int:
    optional_function(progress, "progress")
    return checked_samples(samples)


def render(
    scene: Scene | str | Path,
    technique: str = "auto",
    size: tuple[int, int] | None = None,
    *,
    settings: Mapping[str, Any] | None = None,
    samples: int | None = None,
    adapter: str = "auto",
    progress: Progress | None = None,
    timed: bool = False,
    time: float | None = None,
) -> Image:
    """One anti-aliased image of `scene`, which may also be a file or builtin:NAME.

    `size`: (width, height) in pixels; the camera's by default. `samples` jittered images are
    averaged (12, 8 of media without surfaces, 64 through a lens or an open shutter). `settings` as
    in `airlight render -D`.
    `progress(stage, share)` is called after each step. `timed` renders a few more frames, for
    `frame_ms` and the milliseconds of each pass in `image.stats`. `time`, seconds, is when a moving
    scene is shown; without it, one whose shutter is open is shown from its animation's start on.
    Raises SceneError, SettingsError, DeviceError.
    """
    scene = scene if isinstance(scene, Scene) else load(scene)
    # An open shutter needs a time; a still has as many samples as its camera asks for.
    time = shutter_time(scene, time)
    samples = _checked(still_samples(scene) if samples is None else samples, progress)
    if progress:
        progress("preparing", 0.0)
    with Renderer(scene, technique, size, settings=settings, adapter=adapter) as renderer:
        image = renderer.frame(time=time, samples=samples, progress=progress)
        assert image is not None
        if not timed:
            return image
        # Frames after the first, which has compiled everything.
        renderer.frame_ms.clear()
        renderer.python_ms.clear()
        for _ in range(4):
            renderer.frame(read=False)
        stats = {**renderer.stats(), "passes": renderer.timed_passes()}
        return dataclasses.replace(image, stats=stats)
