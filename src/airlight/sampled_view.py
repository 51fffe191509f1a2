"""An image of a view: its samples drawn one by one, averaged on the device, metered, read back."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable

import numpy as np

from .gpu.commands import Commands
from .lighting.accumulate import Accumulator
from .lighting.read_layers import read_layers
from .lighting.view import View
from .maths.sampling import pixel_jitter
from .maths.tone import auto_exposure
from .scene.image import Image
from .scene.lens import through_lens
from .scene.nearby import Nearby
from .scene.scene import Scene
from .scene.shown import has_unlit
from .techniques.technique import Technique

Progress = Callable[[str, float], None]


class SampledView:
    """The samples of a view's images, drawn by a technique that has solved the scene."""

    def __init__(self, view: View, technique: Technique, commands: Commands, near: Nearby) -> None:
        """`near`: the origin of positions on the device."""
        self._view, self._technique, self._commands = view, technique, commands
        self._nearby, self._means = near, commands.gpu.scope()
        self._accumulator: Accumulator | None = None

    def resize(self, size: tuple[int, int]) -> None:
        """Draw images of `size`, pixels, from here on."""
        # Means are for images of one size; the solved fields stay.
        self._means.release()
        self._accumulator = None
        self._technique.resize(size)
        self._view.resize(size)

    def draw(self, scenes: Iterable[Scene], samples: int, progress: Progress | None = None) -> None:
        """Draw one sample of each of the solved `scenes`, as many as `samples`; submit all work.

        A scene is taken when its sample is about to be drawn.
        """
        self._view.is_still = samples > 1
        if samples == 1:
            # Without anti-aliasing the one sample lies in the middle of its pixel.
            self._view.aim(self._nearby.camera(next(iter(scenes)).camera))
            self._technique.draw(self._commands, self._view)
        else:
            self._draw_still(scenes, samples, progress)
        self._commands.submit()

    def _draw_still(self, scenes: Iterable[Scene], samples: int, progress: Progress | None) -> None:
        # What takes longest serves several images of a sample, which differ by their jitters.
        count = self._technique.jitters(samples)
        jitters = pixel_jitter(samples * count).reshape(samples, count, 2)
        for sample, scene in zip(range(samples), scenes, strict=False):
            # The first, for which gathers choose their points, is the nearest to pixels' middles.
            nearest = np.linalg.norm(jitters[sample], axis=1).argsort()
            for index, jitter in enumerate(jitters[sample][nearest]):
                # Through a lens each sample has a point of it.
                offset = (float(jitter[0]), float(jitter[1]))
                camera, offset = through_lens(scene.camera, offset, sample, self._view.size[1])
                self._view.aim(self._nearby.camera(camera), offset, sample, (index, count))
                # All are averaged on the device, and submitted one by one.
                self._technique.draw(self._commands, self._view)
                self._accumulate(sample * count + index)
                self._commands.submit()
            if progress:
                self._commands.gpu.wait()
                progress("render", (sample + 1) / samples)

    def metered(self, scene: Scene) -> float:
        """The exposure, stops, of an image without its unlit surfaces, which then follow it."""
        self._view.metered_stops = math.inf  # they are black, which is not metered
        self.draw(itertools.repeat(scene), 1)
        self._commands.gpu.wait()
        layers = self._technique.layers(self._view)
        return auto_exposure(read_layers(self._view, layers, None)[1])

    def image(self, scene: Scene, samples: int) -> Image:
        """What was drawn last, with its layers; `scene` says how it is exposed."""
        textures = self._technique.layers(self._view)
        means = self._accumulator if samples > 1 else None
        layers, radiance = read_layers(self._view, textures, means)

        # Exposure follows the image itself, unless unlit surfaces were drawn for one.
        stops = scene.camera.exposure_stops
        if stops is None:
            is_known = has_unlit(scene)
            stops = self._view.metered_stops if is_known else float(auto_exposure(radiance))
        return Image(radiance, layers, exposure_stops=stops)

    def _accumulate(self, index: int) -> None:
        layers = self._technique.layers(self._view)

        # The accumulator is made for the layers that the technique yields.
        if self._accumulator is None:
            self._accumulator = Accumulator(self._means, self._view.size, tuple(layers))
        with self._commands.stage("accumulate"):
            self._accumulator.encode(self._commands, layers, index)
