"""Volumes that only absorb: what a lattice sees of those whose light another solver knows.

Light that they scatter goes straight on there, as most does that is scattered forwards: so the
lattice lacks what volumes absorb of the light that surfaces and fog send, and nothing else.
"""

from __future__ import annotations

import dataclasses

from ..scene.scene import Scene
from ..scene.volume import Volume


def absorbing_volumes(scene: Scene) -> Scene:
    """`scene` with volumes of sigma_t = sigma_a, which neither scatter nor emit."""
    return dataclasses.replace(scene, volumes=tuple(_absorbing(v) for v in scene.volumes))


def _absorbing(volume: Volume) -> Volume:
    r, g, b = (t * (1.0 - w) for t, w in zip(volume.sigma_t, volume.albedo, strict=True))
    none = (0.0, 0.0, 0.0)
    return dataclasses.replace(volume, sigma_t=(r, g, b), albedo=none, g=none, emission=None)
