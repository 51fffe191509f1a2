"""The paper's geometry volume: surfels of views as spherical harmonics (Kaplanyan2010, 3.2).

A surfel of area A and normal n blocks light of travel direction D with probability A/s^2 max(0,
-n.D); in two bands A/s^2 (1/4 + n.w/2) at w = -D, stored as (a, b). Its cells lie half a cell
beside the lattice's, around their corners. Each view has a volume of its own, into which all its
peeled layers go; volumes are merged by a maximum. A hop is blocked by the mean of the four corners
of the face it crosses.
differs: the maximum is that of whole vectors, the one with the larger a: component by component it
would tear the signed lobes apart. A wall stays 3/4 closed, as two bands have it.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.memory import Buffer
from ..gpu.slots import image, storage, uniform
from ..lattice.blockers import Blockers
from ..lattice.view_surfels import SumTexels, ViewBlockers, ViewSurfelParams
from ..surface.light_views import LightView
from ..surface.surfel_views import SurfelViews

_UNITS = 2.0**20  # fixed-point units per fully covered cell face
_VALUES = 5  # (a, b) and a times reflectance


class _Inject(SumTexels):
    file = "geometry_inject.wgsl"


class _Merge(ComputePass):
    slots = (
        uniform("params", ViewSurfelParams),
        storage("sums", "i32", "read_write"),
        storage("volume", "vec4f", "read_write"),
        storage("reflected", "f32", "read_write"),
    )
    workgroup = (256, 1, 1)
    file = "geometry_merge.wgsl"


class _Faces(ComputePass):
    slots = (
        uniform("params", ViewSurfelParams),
        storage("volume", "vec4f"),
        storage("reflected", "f32"),
        storage("faces", "vec4u", "read_write"),
        image("visibility_a", "rgba8unorm", "3d"),
        image("visibility_b", "rgba8unorm", "3d"),
    )
    workgroup = (32, 8, 1)
    file = "geometry_faces.wgsl"


class GeometryVolume(ViewBlockers):
    """By two bands of spherical harmonics, from which it makes `blockers.faces`.

    Surfels of earlier frames stay as long as geometry and lattice do (section 3.2).
    """

    def __init__(self, gpu: Gpu, blockers: Blockers, *, accumulates: bool) -> None:
        super().__init__(blockers, accumulates=accumulates)

        # Sums of one view, and the volume that all views are merged into.
        corners = blockers.corners
        self._sums = Buffer(gpu, "surfels of a view", corners * _VALUES * 4)
        self._volume = Buffer(gpu, "geometry volume", corners * 16)
        self._reflected = Buffer(gpu, "its reflectance", corners * 4)
        self._inject, self._merge, self._faces = _Inject(gpu), _Merge(gpu), _Faces(gpu)

    def _clear(self, commands: Commands) -> None:
        for buffer in (self._volume, self._reflected):
            commands.encoder.clear_buffer(buffer.handle)

    def _add(self, commands: Commands, maps: SurfelViews, views: Sequence[LightView]) -> None:
        """Merge the surfels of each view, and compute from them what blocks between cells."""
        commands.encoder.clear_buffer(self._sums.handle)
        for index in range(len(views)):
            self._add_view(commands, maps, index)
        # What propagation and lookup read.
        blockers = self.blockers
        blockers.note_change()
        self._faces.dispatch(
            commands,
            blockers.placement.count,
            params=ViewSurfelParams.of_view(blockers, maps, 0, _UNITS),
            volume=self._volume,
            reflected=self._reflected,
            faces=blockers.faces,
            visibility_a=blockers.visibility_a,
            visibility_b=blockers.visibility_b,
        )

    def _add_view(self, commands: Commands, maps: SurfelViews, index: int) -> None:
        """Sum the surfels of a view, and merge them into the volume by their maximum."""
        # Corners that a view covers more than all before take its vector.
        params = ViewSurfelParams.of_view(self.blockers, maps, index, _UNITS)
        self._inject.encode(commands, maps, self.blockers.placement, self._sums, params)
        self._merge.dispatch(
            commands,
            (self.blockers.corners,),
            params=params,
            sums=self._sums,
            volume=self._volume,
            reflected=self._reflected,
        )
