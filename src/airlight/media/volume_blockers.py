"""Volumes as blockers of a lattice that otherwise knows surfaces only.

Light that propagates to the next cell collides with the reduced extinction of both cells. Scattered
light goes to both sides alike, and collides again. This is the two-stream model (Schuster1905, of
light in fog), as shares that a face reflects and stops; see `maths.two_streams`. A cell that is
filled in part has a layer in each of 25 columns: light passes beside dense media.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from ..lattice.placement import LatticeParams, Placement
from ..maths.transforms import F64
from .gpu_media import GpuMedia

_SPREAD_BYTES = 80  # this and the next two as in `wgsl/column_spread.wgsl`
_SAMPLES, _HALVES = 125, 150


class VolumeBlockerParams(Struct):
    """Counts of loops, which drivers unroll where they are constants."""

    samples = u32("of the density in a cell")
    halves = u32("of columns of samples")


class FaceParams(Struct):
    """The boxes within which walls are known."""

    boxes = u32()


class _Cells(ComputePass):
    workgroup = (8, 8, 4)
    file = "volume_blockers_cells.wgsl"

    def __init__(self, gpu: Gpu, media: GpuMedia) -> None:
        self.slots = (
            uniform("params", VolumeBlockerParams),
            uniform("lattice", LatticeParams),
            storage("cells", "vec4f", "read_write"),
            storage("spread", "u32", "read_write"),
            *media.medium_slots,
        )
        super().__init__(gpu, generated=media.medium_wgsl)


class _Faces(ComputePass):
    slots = (
        uniform("params", FaceParams),
        uniform("lattice", LatticeParams),
        storage("cells", "vec4f"),
        storage("spread", "u32"),
        storage("walls", "vec4u"),
        storage("boxes", "mat4x4f"),
        storage("faces", "vec4u", "read_write"),
        storage("known", "vec4u", "read_write"),
    )
    workgroup = (8, 8, 4)
    file = "volume_blockers.wgsl"


class VolumeBlockers:
    """`faces`: those of `lattice.blockers.Blockers`, and the volumes between.

    `known_faces`: the same, where walls reflect near the volumes alone: light that volumes send
    goes there by paths that their own solvers know.
    """

    def __init__(self, gpu: Gpu, media: GpuMedia, cells: int) -> None:
        self._media = media
        self._cells = Buffer(gpu, "media in cells", 16 * cells)
        self._spread = Buffer(gpu, "how media fill cells", _SPREAD_BYTES * cells)
        self.faces = Buffer(gpu, "cell faces in media", 32 * cells)
        self.known_faces = Buffer(gpu, "cell faces in media, walls far off black", 32 * cells)
        self._sample, self._combine = _Cells(gpu, media), _Faces(gpu)
        # A box for each medium at most.
        self._boxes = Buffer(gpu, "boxes of known walls", 64 * max(1, media.count))

    def encode(
        self,
        commands: Commands,
        placement: Placement,
        walls: Buffer,
        boxes: Sequence[F64] = (),
    ) -> None:
        """Fill `faces` from the `walls` of the blockers and the volumes.

        `boxes` (4, 4): from the world to 0..1 in each box within which walls are known to the
        volumes' solvers; no more than there are media.
        """
        # What the volumes of a cell take away, then with what its walls do.
        lattice = placement.params()
        self._sample.dispatch(
            commands,
            placement.count,
            params=VolumeBlockerParams(samples=_SAMPLES, halves=_HALVES),
            lattice=lattice,
            cells=self._cells,
            spread=self._spread,
            **self._media.medium_bound,
        )
        if boxes:
            # Matrices lie column by column.
            self._boxes.write(np.array([b.T for b in boxes], np.float32))
        self._combine.dispatch(
            commands,
            placement.count,
            params=FaceParams(boxes=len(boxes)),
            lattice=lattice,
            cells=self._cells,
            spread=self._spread,
            walls=walls,
            boxes=self._boxes,
            faces=self.faces,
            known=self.known_faces,
        )
