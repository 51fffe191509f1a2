"""Media as light meets them on its way to surfaces that reflect it into media again.

Of what a medium scatters, the share g^(3/2) stays in its beam (`maths.delta_beam`), and reaches
the surfaces behind: in the shadow of smoke of g .7 that is most of the light there is to reflect.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

import numpy as np

from ...maths.delta_beam import beam_loss
from ...scene.medium import Medium
from ...scene.scene import Scene
from ...scene.volume import Volume

_M = TypeVar("_M", Medium, Volume)


class ForwardScaled:
    """Scenes whose media have the extinction of such beams; what they scatter is as it was.

    A volume that stays the same object stays one.
    """

    def __init__(self) -> None:
        self._made: list[tuple[Volume, Volume]] = []

    def scaled(self, scene: Scene) -> Scene:
        """The scene with its media so."""
        medium = None if scene.medium is None else _scaled(scene.medium)
        # An unchanged volume stays the same object, which later stages know by identity.
        known = {id(volume): made for volume, made in self._made}
        volumes = tuple(known.get(id(v)) or _scaled(v) for v in scene.volumes)
        self._made = list(zip(scene.volumes, volumes, strict=True))
        return replace(scene, medium=medium, volumes=volumes)


def _scaled(medium: _M) -> _M:
    # Light is lost to the beam where it is absorbed or scattered otherwise than forwards.
    lost = np.asarray(medium.sigma_t) * beam_loss(medium.g, medium.albedo)
    r, g, b = (float(x) for x in lost)
    return replace(medium, sigma_t=(r, g, b))
