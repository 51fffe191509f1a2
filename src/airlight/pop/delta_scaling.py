"""Delta scaling of media whose phase function is sharper than the ordinates resolve.

Light that such a medium scatters hardly leaves its direction, while an ordinate spreads it over a
part of the sky: a surface behind the medium would be hidden by that blur. The forward peak of the
phase function therefore counts as unscattered, which keeps absorption and the transport coefficient
sigma_s (1 - g) (delta scaling; Joseph1976).
"""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

import numpy as np

from ..maths.transforms import triple
from ..scene.medium import Medium
from ..scene.scene import Scene
from ..scene.volume import Volume

SHARPEST = 0.97  # mean cosine; an ordinate of 64 has 0.95 to 0.99
_M = TypeVar("_M", Medium, Volume)


class DeltaScaling:
    """Scenes without a lobe sharper than SHARPEST; an unchanged volume stays the same object."""

    def __init__(self) -> None:
        self._made: list[tuple[Volume, Volume]] = []

    def scaled(self, scene: Scene) -> Scene:
        """The scene, with media scaled where their lobes are sharper."""
        medium = scene.medium
        if medium is not None and max(medium.g) > SHARPEST:
            scene = replace(scene, medium=_scaled(medium))
        if all(max(volume.g) <= SHARPEST for volume in scene.volumes):
            return scene
        # An unchanged volume gives the same object as before, which later stages know it by.
        volumes = tuple(self._of(volume) for volume in scene.volumes)
        self._made = list(zip(scene.volumes, volumes, strict=True))
        return replace(scene, volumes=volumes)

    def _of(self, volume: Volume) -> Volume:
        if max(volume.g) <= SHARPEST:
            return volume
        # A volume is scaled once, so that it is the same one in each frame.
        made = (scaled for known, scaled in self._made if known is volume)
        return next(made, None) or _scaled(volume)


def _scaled(medium: _M) -> _M:
    """The medium without the forward peak; as much is absorbed, and sigma_s (1 - g) stays."""
    g, albedo = np.array(medium.g), np.array(medium.albedo)
    # Of scattering the share f goes straight on: sigma_t' = (1 - albedo f) sigma_t, with f such
    # that g' = (g - f)/(1 - f) is SHARPEST (Joseph1976).
    unscattered = np.maximum(g - SHARPEST, 0.0) / (1.0 - SHARPEST)
    left = 1.0 - albedo * unscattered
    return replace(
        medium,
        g=triple(np.minimum(g, SHARPEST)),
        sigma_t=triple(np.array(medium.sigma_t) * left),
        albedo=triple(np.minimum(albedo * (1.0 - unscattered) / left, 1.0)),
    )
