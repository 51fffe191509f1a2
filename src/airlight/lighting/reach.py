"""How far lattices reach into a medium, and which other scenes a renderer can show with them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..lattice.nested import Box
from ..lattice.placement import Triple
from ..maths.transforms import box_along, box_around, triple
from ..scene.along import whole_bounds_along
from ..scene.checks import F64
from ..scene.light_shapes import furnished
from ..scene.medium import Medium, medium_box
from ..scene.placing import camera_at
from ..scene.scene import Scene
from ..scene.shown import drawn_alike

_HIDDEN = 10.0
"""Optical depths behind which nothing of a medium is seen: as far a lattice of its own reaches."""
_MORE = 0.5
"""Of the longest side of what is reached: the least that is added for an eye beyond it."""
_SPARE = 0.02
"""Of the longest side of what an eye sees: about half of a cell, which may be beyond."""


@dataclass(frozen=True)
class Reach:
    """What a scene's own eyes see of its medium; boxes in metres of the world.

    `seen`: the scene with its volumes. `surfaces`: those alone. `eyes`: where its cameras are.
    """

    medium: Medium
    seen: tuple[F64, F64]
    surfaces: tuple[F64, F64]
    eyes: tuple[Triple, ...]

    def for_eye(self, eye: Triple) -> tuple[F64, F64]:
        """The box of what is seen of the medium from `eye`, as far as surfaces or it are near."""
        least, most = medium_box(self.medium, *self.seen, eye)
        depth = _HIDDEN / min(c for c in self.medium.sigma_t if c > 0.0)
        near = np.clip(np.asarray(eye, np.float64), least, most)
        # Around surfaces, and around the eye or where it looks into the medium.
        first = np.minimum(self.surfaces[0], near) - depth
        last = np.maximum(self.surfaces[1], near) + depth
        return np.maximum(least, first), np.minimum(most, last)

    def along(self, axes: F64) -> Box:
        """The box of what its eyes see, metres along `axes` (3, 3), rows."""
        boxes = [box_along(axes, *self.for_eye(eye)) for eye in self.eyes]
        low, high = box_around(boxes)
        return triple(low), triple(high)

    @cached_property
    def box(self) -> tuple[F64, F64]:
        """The box of what its eyes see, metres of the world."""
        low, high = self.along(np.eye(3))
        return np.array(low), np.array(high)

    def beyond(self, scene: Scene) -> Triple | None:
        """An eye that sees all that the camera of `scene` does beyond this reach; None if nothing.

        It is the same for all cameras up to twice as far, so that lattices made for it last.
        """
        if scene.medium is None:
            return None
        low, high = self.box
        first, last = replace(self, medium=scene.medium).for_eye(scene.camera.position)
        more = np.maximum(low - first, last - high)
        is_beyond = more > _SPARE * float(np.maximum(high - low, last - first).max())
        if not is_beyond.any():
            return None
        # In powers of two of what is reached, on the sides on which the eye is beyond it.
        unit = _MORE * float((high - low).max())
        steps = unit * 2.0 ** np.ceil(np.log2(np.maximum(more / unit, 1.0)))
        own = np.array(self.eyes)
        below = np.minimum(self.surfaces[0], own.min(axis=0)) - steps
        above = np.maximum(self.surfaces[1], own.max(axis=0)) + steps
        stepped = np.where(last - high >= low - first, above, below)
        return triple(np.where(is_beyond, stepped, own[0]))


@dataclass(frozen=True)
class MadeFor:
    """What a renderer's resources are made for: the `first` scene, and an `eye` far out in it.

    `follows_eye`: whether its lattices hold light in the medium, as far as cameras see it.
    """

    first: Scene
    eye: Triple | None = None
    follows_eye: bool = False

    @property
    def scene(self) -> Scene:
        """The scene to make them for; its camera is where lattices have to reach."""
        if self.eye is None:
            return self.first
        return replace(self.first, camera=camera_at(self.first.camera, self.eye))

    @cached_property
    def reach(self) -> Reach | None:
        """What the first scene's eyes see of a medium; None where lattices do not follow them."""
        return reach_of(self.first) if self.follows_eye else None

    def following(self, follows_eye: bool) -> MadeFor:
        """The same for lattices that do or do not follow cameras."""
        return replace(self, follows_eye=follows_eye)

    def showing(self, scene: Scene) -> MadeFor:
        """What resources have to be made for to show `scene`: the very same where they fit it."""
        # Another scene asks for other resources, an eye beyond the reach for larger lattices.
        made = self
        if not drawn_alike(scene, self.first):
            # All else stays as it was first, so that a frame does not depend on those before it.
            first = replace(self.first, volumes=scene.volumes)
            made = MadeFor(first, follows_eye=self.follows_eye)
        eye = made.reach.beyond(scene) if made.reach else None
        return made if eye == made.eye else replace(made, eye=eye)


def reach_of(scene: Scene) -> Reach | None:
    """What a scene's eyes see of its medium; None without one, or where it is endless.

    The far light of an endless medium is in a table of its own (`media.half_space`).
    """
    # A medium without extinction is not seen.
    medium = scene.medium
    if medium is None or medium.endless or not any(medium.sigma_t):
        return None
    seen = whole_bounds_along(scene, np.eye(3))
    surfaces = whole_bounds_along(furnished(scene), np.eye(3))
    eyes = tuple(triple(np.asarray(eye, np.float64)) for eye in eyes_of(scene))
    return Reach(medium, seen, surfaces, eyes)


def eyes_of(scene: Scene) -> Sequence[Triple]:
    """Where cameras are: a medium without bounds reaches to them, wherever they go."""
    return [scene.camera.position] if scene.animation is None else scene.animation.eyes(scene)
