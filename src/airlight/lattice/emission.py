"""Emissive surfaces into cells: low-frequency direct light (Kaplanyan2010 section 3.1).

Each surfel of an emissive mesh is a virtual point light of power pi L A, a cosine lobe along its
normal; two-sided sheets give one to each side.
"""

from __future__ import annotations

import numpy as np

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.layout import Struct, u32
from ..gpu.slots import storage, uniform
from ..scene.mesh import Mesh
from ..surface.geometry import InstanceData
from .blockers import Blockers
from .lobes import TARGET_SLOTS, InjectionTarget, Lobe
from .surfels import SurfelData, triangle_areas


class EmissionParams(Struct):
    """How many surfels there are."""

    surfel_count = u32()


class InjectEmission(ComputePass):
    """Adds every emissive surfel to the fixed-point sums."""

    slots = (
        uniform("params", EmissionParams),
        storage("surfels", SurfelData),
        storage("instances", InstanceData),
        *TARGET_SLOTS,
    )
    workgroup = (256, 1, 1)

    def encode(
        self,
        commands: Commands,
        blockers: Blockers,
        target: InjectionTarget,
        lobe: Lobe,
    ) -> None:
        """Parameters as in `Inject.encode`."""
        self.dispatch(
            commands,
            (blockers.count,),
            params=EmissionParams(surfel_count=blockers.count),
            surfels=blockers.surfels,
            instances=blockers.meshes.instances,
            **target.bound(lobe),
        )


def emitted_flux(meshes: tuple[Mesh, ...]) -> float:
    """An upper bound, W, of what emissive surfaces give."""
    return float(
        sum(
            np.pi * max(m.material.emission) * triangle_areas(m).sum() * 2.0
            for m in meshes
            if m.material.is_emissive
        )
    )
