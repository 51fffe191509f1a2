"""Groups of point lights injected into cells (Kaplanyan2010 section 3.1).

One dispatch adds thousands of lights, each as the isotropic light of its cell. They have no shadow
maps; the blockers of propagation shadow them.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32, vec3f
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from ..scene.fingerprint import is_same
from ..scene.point_lights import PointLights
from .lobes import COSINE, TARGET_SLOTS, InjectionTarget


class PointData(Struct):
    """One light."""

    position = vec3f("m")
    pad = u32()
    intensity = vec3f("W sr^-1")
    pad_end = u32()


class PointParams(Struct):
    """How many lights there are."""

    lights = u32()


class _InjectPoints(ComputePass):
    slots = (
        uniform("params", PointParams),
        storage("points", PointData),
        *TARGET_SLOTS,
    )
    workgroup = (256, 1, 1)
    file = "point_lights.wgsl"


class InjectPoints:
    """Stores the lights on the device and adds them to fixed-point sums.

    Groups are uploaded when they are other arrays than in the frame before; they may grow.
    """

    def __init__(self, gpu: Gpu) -> None:
        self.gpu, self.count = gpu, 0
        self._pass: _InjectPoints | None = None
        self._points: Buffer | None = None
        self._groups: tuple[PointLights, ...] = ()

    def take(self, groups: Sequence[PointLights]) -> float:
        """Set the groups of lights; returns the power, W, of all of them."""
        # Groups are compared by identity: other arrays are other lights.
        if not is_same(groups, self._groups):
            self._groups = tuple(groups)
            self.count = sum(map(len, groups))
            self._upload()
        return sum(group.power for group in groups)

    def encode(self, commands: Commands, target: InjectionTarget) -> None:
        """Add all lights."""
        if not self.count:
            return
        if self._pass is None:
            self._pass = _InjectPoints(self.gpu)
        self._pass.dispatch(
            commands,
            (self.count,),
            params=PointParams(lights=self.count),
            points=self._points,
            **target.bound(COSINE),
        )

    def _upload(self) -> None:
        rows = np.zeros(max(1, self.count), PointData.dtype)
        if self.count:
            rows["position"] = np.concatenate([g.positions for g in self._groups])
            rows["intensity"] = np.concatenate([g.intensities for g in self._groups])
        # The buffer grows where there are more lights than ever before.
        if self._points is None or self._points.nbytes < rows.nbytes:
            if self._points is not None:
                self._points.release()
            self._points = Buffer(self.gpu, "point lights", rows.nbytes)
        self._points.write(rows)
