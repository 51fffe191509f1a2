"""Reduced media: isotropic ones that stand for media that scatter forwards (similarity theory).

After many scatterings light depends on sigma_s (1 - g) alone. The lattice solves an isotropic
medium of that coefficient; light scattered once is drawn with the true phase function.
Source: similarity theory (Wyman1989), order one.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any, TypeVar

from ..scene.fingerprint import is_same
from ..scene.medium import Medium
from ..scene.scene import Scene
from ..scene.volume import Volume

AnyMedium = TypeVar("AnyMedium", Medium, Volume)


class ChangedMedia:
    """Scenes whose media are changed; one that stays the same object stays one, by which later
    stages know it.
    """

    def __init__(self, change: Callable[[Any], Any], *, has_medium: bool = True) -> None:
        """`change`: gives the medium or volume that stands for another one.

        `has_medium`: whether the scene's own medium is changed, too.
        """
        self._change, self._has_medium = change, has_medium
        self._made: dict[int, tuple[Any, Any]] = {}

    def of(self, scene: Scene) -> Scene:
        """The scene with its media so; itself where all of them stay."""
        own, known = scene.medium if self._has_medium else None, self._made
        media = (*scene.volumes, *((own,) if own else ()))
        self._made = {id(m): known.get(id(m)) or (m, self._change(m)) for m in media}
        volumes = tuple(self._made[id(v)][1] for v in scene.volumes)
        medium = self._made[id(own)][1] if own else scene.medium
        if is_same((medium, *volumes), (scene.medium, *scene.volumes)):
            return scene
        return dataclasses.replace(scene, medium=medium, volumes=volumes)


def reduced_scene(scene: Scene) -> Scene:
    """`scene` with reduced isotropic media; itself where they are isotropic already."""
    if not is_forward(scene):
        return scene
    return dataclasses.replace(
        scene,
        medium=reduced(scene.medium) if scene.medium else None,
        volumes=tuple(reduced(v) for v in scene.volumes),
    )


def is_forward(scene: Scene, *, least: float = -1.0) -> bool:
    """Whether any medium scatters anisotropically, with a mean cosine above `least`."""
    media = [*((scene.medium,) if scene.medium else ()), *scene.volumes]
    return any(c != 0.0 and c > least for m in media for c in m.g)


def reduced(medium: AnyMedium) -> AnyMedium:
    """sigma_s' = sigma_s (1 - g), sigma_t' = sigma_s' + sigma_a. Its g says what it stands for."""
    # 1 - albedo g of the extinction is left, and of that sigma_s (1 - g) scatters.
    kept = [1.0 - w * g for w, g in zip(medium.albedo, medium.g, strict=True)]
    r, g, b = (t * k for t, k in zip(medium.sigma_t, kept, strict=True))
    x, y, z = (
        min(1.0, w * (1.0 - c) / k) if k > 0.0 else 0.0
        for w, c, k in zip(medium.albedo, medium.g, kept, strict=True)
    )
    return dataclasses.replace(medium, sigma_t=(r, g, b), albedo=(x, y, z))


def absorbing_volumes(scene: Scene) -> Scene:
    """`scene` with volumes of sigma_t = sigma_a, which neither scatter nor emit.

    What a lattice sees of those whose light another solver knows: light that they scatter goes
    straight on there, as most does that is scattered forwards, so the lattice lacks what they
    absorb, and nothing else.
    """
    return dataclasses.replace(scene, volumes=tuple(_absorbing(v) for v in scene.volumes))


def _absorbing(volume: Volume) -> Volume:
    r, g, b = (t * (1.0 - w) for t, w in zip(volume.sigma_t, volume.albedo, strict=True))
    none = (0.0, 0.0, 0.0)
    return dataclasses.replace(volume, sigma_t=(r, g, b), albedo=none, g=none, emission=None)
