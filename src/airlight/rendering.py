"""Scene + technique -> image, without a window."""

from __future__ import annotations

import dataclasses
import math
import statistics
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from time import perf_counter
from types import TracebackType
from typing import Any

import numpy as np

from .errors import DeviceError, SettingsError
from .gpu.commands import Commands
from .gpu.device import open_gpu
from .gpu.one_thread import OneThread
from .gpu.process import enter_driver, is_forked
from .lighting.accumulate import Accumulator
from .lighting.kit import Context
from .lighting.read_layers import read_layers
from .lighting.view import View
from .maths.sampling import pixel_jitter, shutter_shares
from .maths.tone import auto_exposure
from .scene.camera import Camera
from .scene.environment import Environment
from .scene.image import Image, checked_size
from .scene.io import load
from .scene.lens import has_moments, shutter_time, still_samples, through_lens
from .scene.lights import Light
from .scene.limits import check_extent
from .scene.mesh import Mesh
from .scene.nearby import Nearby, origin_near
from .scene.point_lights import PointLights
from .scene.scene import Scene
from .scene.shown import ShownScenes, changed, drawn_alike, has_unlit
from .scene.volume import Volume
from .surface.geometry import GpuScene
from .techniques import make_technique

Progress = Callable[[str, float], None]
_MOST_TIMES = 256


class Renderer:
    """Keeps a scene on the device, for animation and for viewers.

    with Renderer(scene, technique="lpv", size=(640, 360)) as r:
        image = r.frame(camera=...)

    The number and kinds of lights, the meshes' triangles and the volumes' grid sizes are fixed;
    everything that `frame` takes may change from call to call. An image depends on the scene that
    the renderer was made with and on the scene it shows, not on the images before it. A path or
    builtin:NAME is loaded. Settings as of `render`. Raises SceneError, SettingsError, DeviceError.

    Each thread may have renderers of its own; one renderer serves one thread at a time, any
    thread, and not a forked process: else DeviceError. A frame that an error or Ctrl-C interrupts
    changes nothing: the next one recreates what it needs.
    """

    def __init__(
        self,
        scene: Scene | str | Path,
        technique: str = "auto",
        size: tuple[int, int] = (1280, 720),
        *,
        settings: Mapping[str, Any] | None = None,
        adapter: str = "auto",
    ) -> None:
        self._began_s = perf_counter()
        self.size = checked_size(size)
        self.scene = self._first = scene if isinstance(scene, Scene) else load(scene)
        check_extent(self.scene)
        self._shown, self._nearby = ShownScenes(), Nearby(origin_near(self.scene))
        self._wanted = (technique, dict(settings or {}), adapter)
        self._one_thread, self._is_closed = OneThread("this Renderer"), False
        self.frame_ms: list[float] = []
        self.python_ms: list[float] = []
        self._first_image_s: float | None = None
        self.exposure_stops: float | None = None
        """Instead of the camera's, where it is a number."""
        self._make()

    def _make(self) -> None:
        """Create all that is on the device, for the scene that is shown."""
        technique, settings, adapter = self._wanted
        self._is_torn = True
        self._accumulator: Accumulator | None = None
        self.gpu = gpu = open_gpu(adapter).scope()
        self._means = gpu.scope()
        gpu.require("max-texture-dimension-2d", max(self.size), "the image")
        gpu.memory.forget_peak()
        # What is made half when an error comes is given back with the stack.
        with gpu.guarded(), ExitStack() as made:
            made.callback(gpu.release)
            self.commands = Commands(gpu)
            first = self._nearby.of(self._shown.of(self._first))
            self.meshes = GpuScene(gpu, first)
            context = Context(gpu, first, self.meshes, self.size, self.commands)
            self.technique = make_technique(context, technique, settings, nearby=self._nearby)
            made.callback(self.technique.release)
            self.view = View(gpu, self.size)
            self._made = made.pop_all()
        self._is_torn = False

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
        with self.used():
            changes: dict[str, Any] = dict(camera=camera, lights=lights, environment=environment)
            changes |= dict(meshes=meshes, volumes=volumes, light_groups=light_groups)
            before = self.scene
            changes |= dict(exposure_stops=self.exposure_stops)
            scene = changed(before if time is None else before.at(time), **changes)
            moments: Iterator[Scene] | None = None
            if time is not None and samples > 1 and has_moments(scene):
                times_s = time + scene.camera.shutter_s * shutter_shares(samples)
                moments = (changed(before.at(t), **changes) for t in times_s.tolist())
            if not drawn_alike(scene, self._first):
                self._first = scene
                self._release()
                self._make()
            with self.whole():
                # Light transport, independent of the view; then the view, once per sample.
                if moments is None or has_unlit(scene):
                    self.technique.solve(self.commands, self.show(scene), is_still=samples > 1)
                self.view.metered_stops = self._meter() if read and has_unlit(scene) else 0.0
                self._draw(samples, progress, moments)
                if moments is not None:
                    self.show(scene)
                encoded = perf_counter()
                self.gpu.wait()
                self._count(begin, encoded, perf_counter())
                return self._image(samples) if read else None

    @property
    def origin(self) -> tuple[float, float, float]:
        """The place in the world, metres, that is the origin of all positions on the device."""
        return self._nearby.origin

    def show(self, scene: Scene) -> Scene:
        """Make `scene` the one that is shown.

        Returns it as the device has it: with its lights' meshes, volumes in parts, from `origin`.
        """
        shown = self._nearby.of(self._shown.of(scene))
        if shown.meshes is not self.meshes.current:
            self.meshes.move(shown.meshes)
        self.scene = scene
        return shown

    def aim(self, camera: Camera, jitter_px: tuple[float, float], sample: int) -> None:
        """Look through `camera`, (x, y) `jitter_px` beside pixels' middles, for image `sample`."""
        self.view.aim(self._nearby.camera(camera), jitter_px, sample)

    def _meter(self) -> float:
        """The exposure of an image without its unlit surfaces, which then follow it."""
        self.view.metered_stops = math.inf  # they are black, which is not metered
        self._draw(1, None)
        self.gpu.wait()
        return auto_exposure(read_layers(self.view, self.technique.layers(self.view), None)[1])

    def _draw(
        self, samples: int, progress: Progress | None, moments: Iterator[Scene] | None = None
    ) -> None:
        """Draw the solved scene once per sample, and submit all work.

        `moments`: what each sample sees instead, made and solved as it comes.
        """
        self.view.is_still = samples > 1
        # Without anti-aliasing the one sample lies in the middle of its pixel.
        jitters = pixel_jitter(samples) if samples > 1 else np.zeros((1, 2))
        for index, jitter in enumerate(jitters):
            if moments is not None:
                self.technique.solve(self.commands, self.show(next(moments)), is_still=True)
            place = (float(jitter[0]), float(jitter[1]))
            camera = self.scene.camera
            if samples > 1:
                camera, place = through_lens(camera, place, index, self.size[1])
            self.aim(camera, place, index)
            self.technique.draw(self.commands, self.view)
            # Several samples are averaged on the device, and submitted one by one.
            if samples > 1:
                self._accumulate(index)
                self.commands.submit()
                if progress:
                    self.gpu.wait()
                    progress("render", (index + 1) / samples)
        self.commands.submit()

    def resize(self, size: tuple[int, int]) -> None:
        """Draw images of `size`, pixels, from here on; the solved fields stay.

        Raises SettingsError, DeviceError.
        """
        size = checked_size(size)
        with self.used():
            if size == self.size:
                return
            self.gpu.require("max-texture-dimension-2d", max(size), "the image")
            with self.whole():
                self._means.release()
                self.size, self._accumulator = size, None
                self.technique.resize(size)
                self.view.resize(size)

    def timed_passes(self) -> dict[str, float]:
        """Milliseconds per stage of one more frame, each stage waited for. Raises DeviceError."""
        with self.used():
            commands = self.commands
            commands.is_timed, commands.stage_ms = True, {}
            try:
                self.frame(read=False)
                self.frame_ms.pop()
                self.python_ms.pop()
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
            "frame_ms": _median(self.frame_ms[1:]),
            "python_ms": _median(self.python_ms[1:]),
            "first_image_s": self._first_image_s,
            "peak_gpu_bytes": self.gpu.peak_bytes,
            "size": list(self.size),
            "triangles": self.scene.triangle_count,
            **self.technique.stats,
        }

    def close(self) -> None:
        """Give the device's memory back; a second call does nothing.

        Raises DeviceError while another thread uses it.
        """
        if is_forked():  # the memory is the parent's
            self._is_closed = True
        if self._is_closed:
            return
        with self._one_thread:
            self._is_closed = True
            self._release()

    def __enter__(self) -> Renderer:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    @contextmanager
    def used(self) -> Iterator[None]:
        """A context in which this thread alone uses the device.

        It recreates the resources that an interrupted frame left undefined. `frame` enters it
        itself.

        Raises DeviceError: another thread is in it, this process was forked, the renderer is
        closed, the device was lost or has no memory left.
        """
        enter_driver()
        with self._one_thread:
            self._check_open()
            if self._is_torn:
                self._release()
                self._make()
            with self.gpu.guarded():
                yield

    @contextmanager
    def whole(self) -> Iterator[None]:
        """A context whose work, if interrupted, leaves no trace: `used` recreates all next time."""
        scene, size = self.scene, self.size
        try:
            yield
        except BaseException:
            self.scene, self.size, self._is_torn = scene, size, True
            raise

    def _check_open(self) -> None:
        if self._is_closed:
            raise DeviceError("this Renderer is closed", remedy="Make a new one")

    def _release(self) -> None:
        """Release all that is on the device."""
        self._made.close()
        self._accumulator = None

    def _count(self, begin: float, encoded: float, done: float) -> None:
        """Store a frame's times, seconds; of a long animation the first and the latest."""
        if self._first_image_s is None:
            self._first_image_s = done - self._began_s
        for stored, spent_s in ((self.frame_ms, done - begin), (self.python_ms, encoded - begin)):
            del stored[1:-_MOST_TIMES]
            stored.append(spent_s * 1e3)

    def _accumulate(self, index: int) -> None:
        layers = self.technique.layers(self.view)
        if self._accumulator is None:
            self._accumulator = Accumulator(self._means, self.size, tuple(layers))
        with self.commands.stage("accumulate"):
            self._accumulator.encode(self.commands, layers, index)

    def _image(self, samples: int) -> Image:
        textures = self.technique.layers(self.view)
        means = self._accumulator if samples > 1 else None
        layers, radiance = read_layers(self.view, textures, means)
        stops = self.scene.camera.exposure_stops
        if stops is None:
            is_known = has_unlit(self.scene)
            stops = self.view.metered_stops if is_known else float(auto_exposure(radiance))
        return Image(radiance, layers, exposure_stops=stops, stats=self.stats())


def render(
    scene: Scene | str | Path,
    technique: str = "auto",
    size: tuple[int, int] = (1280, 720),
    *,
    settings: Mapping[str, Any] | None = None,
    samples: int | None = None,
    adapter: str = "auto",
    progress: Progress | None = None,
    timed: bool = False,
    time: float | None = None,
) -> Image:
    """One anti-aliased image of `scene`, which may also be a file or builtin:NAME.

    `size`: (width, height) in pixels. `samples` jittered images are averaged (8, or 64
    where the camera has a lens, or a shutter while things move). `settings` as in
    `airlight render -D`.
    `progress(stage, share)` is called after each step. `timed` renders a few more frames, for
    `frame_ms` and the milliseconds of each pass in `image.stats`. `time`, seconds, is when a moving
    scene is shown; without it, one whose shutter is open is shown from its animation's start on.
    Raises SceneError, SettingsError, DeviceError.
    """
    if isinstance(scene, (str, Path)):
        scene = load(scene)
    time = shutter_time(scene, time)
    samples = still_samples(scene) if samples is None else samples
    if samples < 1 or samples > 4096:
        raise SettingsError(f"samples = {samples} is out of range", remedy="It goes from 1 to 4096")
    if progress:
        progress("upload", 0.0)
    with Renderer(scene, technique, size, settings=settings, adapter=adapter) as renderer:
        image = renderer.frame(time=time, samples=samples, progress=progress)
        assert image is not None
        if not timed:
            return image
        # Times are those of single samples, once everything is compiled.
        renderer.frame_ms.clear()
        renderer.python_ms.clear()
        for _ in range(4):
            renderer.frame(read=False)
        stats = {**renderer.stats(), "passes": renderer.timed_passes()}
        return dataclasses.replace(image, stats=stats)


def _median(times_ms: Sequence[float]) -> float | None:
    return statistics.median(times_ms) if times_ms else None
