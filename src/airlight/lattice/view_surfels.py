"""Surfels from the views of camera and lights: blockers as in Kaplanyan2010 section 3.2.

Each texel of a view is a surfel of the surface that it shows, and blocks light towards its visible
side. All peeled layers of a buffer (the camera's, or all faces of a light's) are summed around the
lattice's corners, as `lattice.blockers` does for surfels of meshes. Buffers are merged by the
maximum, which non-negative projected areas allow: a surface in two of them blocks once.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import replace

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32, vec3u
from ..gpu.memory import Buffer
from ..gpu.rows import table
from ..gpu.slots import storage, texture, uniform
from ..surface.geometry import GpuScene
from ..surface.light_views import LightView, LightViewData
from ..surface.surfel_views import SurfelViews
from .blockers import UNITS, Blockers
from .placement import LatticeParams, Placement

_FINER = 16.0
"""A view's areas are summed in units so much finer: texels near the eye show little each."""


class ViewSurfelParams(Struct):
    """How many corners there are, and which view's layers are put in."""

    count = vec3u("cells")
    units = f32("fixed-point units per fully covered face, in a buffer's sums")
    resolution = u32("texels")
    view = u32()
    first_layer = u32()
    finer = f32("those units over those of the merged sums")
    corners = u32("around the lattice's cells")
    first_row = u32("where its cells begin along y of the textures")

    @classmethod
    def of_view(
        cls, blockers: Blockers, maps: SurfelViews, view: int, units: float, finer: float = 1.0
    ) -> ViewSurfelParams:
        """The parameters of view number `view` of `maps`."""
        placement = blockers.placement
        return cls(
            count=placement.count,
            first_row=placement.first_row,
            corners=blockers.corners,
            units=units,
            finer=finer,
            resolution=maps.resolution,
            view=view,
            first_layer=view * maps.peels,
        )


class SumTexels(ComputePass):
    """Each texel of a view's layers is a surfel that adds to sums around the lattice's corners."""

    slots = (
        uniform("params", ViewSurfelParams),
        uniform("lattice", LatticeParams),
        table("views", LightViewData),
        texture("depth", "2d-array", "depth"),
        texture("normal", "2d-array", "unfilterable-float"),
        texture("reflectance", "2d-array", "unfilterable-float"),
        storage("sums", "atomic<i32>", "read_write"),
    )
    workgroup = (16, 16, 1)

    def encode(
        self,
        commands: Commands,
        maps: SurfelViews,
        placement: Placement,
        sums: Buffer,
        params: ViewSurfelParams,
    ) -> None:
        """Add all layers of the view that `params` names, in the lattice at `placement`."""
        self.dispatch(
            commands,
            (maps.resolution, maps.resolution, maps.peels),
            params=params,
            lattice=placement.params(),
            views=maps.views,
            depth=maps.depth,
            normal=maps.normal,
            reflectance=maps.reflectance,
            sums=sums,
        )


class _SumSides(SumTexels):
    file = "view_surfels.wgsl"


class _MergeSums(ComputePass):
    slots = (
        uniform("params", ViewSurfelParams),
        storage("sums", "i32", "read_write"),
        storage("merged", "i32", "read_write"),
    )
    workgroup = (256, 1, 1)
    file = "merge_sums.wgsl"


class ViewBlockers(ABC):
    """Fills `blockers` from views, instead of their own passes; how, derived classes say.

    `accumulates`: surfels of earlier frames stay until geometry or lattice change.
    """

    def __init__(self, blockers: Blockers, *, accumulates: bool) -> None:
        self.blockers, self.accumulates = blockers, accumulates
        self._made: tuple[int, Placement] | None = None

    def encode(
        self,
        commands: Commands,
        meshes: GpuScene,
        maps: SurfelViews,
        views: Sequence[LightView],
        *,
        is_drawn: bool,
    ) -> bool:
        """Update the blockers to `maps`, the camera's view first; returns whether they changed.

        `is_drawn`: a view was redrawn.
        """
        # What surfels depend on beside the views.
        made = (meshes.version, replace(self.blockers.placement, fade=None))
        is_new, self._made = made != self._made, made
        if not (is_new or is_drawn):
            return False
        # What earlier frames saw stays, as long as it stands where it stood.
        if is_new or not self.accumulates:
            self._clear(commands)
        self._add(commands, maps, views)
        return True

    @abstractmethod
    def _clear(self, commands: Commands) -> None:
        """Forget the surfels of earlier frames."""

    @abstractmethod
    def _add(self, commands: Commands, maps: SurfelViews, views: Sequence[LightView]) -> None:
        """Add the surfels of all views, and compute the blockers' faces."""


class ViewSurfels(ViewBlockers):
    """By the sums of `blockers`.

    `has_meshes`: the surfels of the meshes are summed beside those of the views.
    """

    def __init__(
        self, gpu: Gpu, blockers: Blockers, *, accumulates: bool, has_meshes: bool
    ) -> None:
        super().__init__(blockers, accumulates=accumulates)
        self.has_meshes = has_meshes
        self._sums = Buffer(gpu, "surfels of a buffer", blockers.sums.nbytes)
        self._sum, self._merge = _SumSides(gpu), _MergeSums(gpu)

    def _clear(self, commands: Commands) -> None:
        self.blockers.clear(commands)
        if self.has_meshes:
            self.blockers.sum_meshes(commands)

    def _add(self, commands: Commands, maps: SurfelViews, views: Sequence[LightView]) -> None:
        """Merge the surfels of each view by the maximum."""
        blockers = self.blockers

        # Sums of one buffer, which each merge leaves empty for the next.
        commands.encoder.clear_buffer(self._sums.handle)
        for index, view in enumerate(views):
            # In finer units, since a texel near the eye covers little of a face.
            params = ViewSurfelParams.of_view(blockers, maps, index, _FINER * UNITS, _FINER)
            self._sum.encode(commands, maps, blockers.placement, self._sums, params)
            # The faces of one light's cube see what is beside each other: one buffer.
            is_last = index + 1 == len(views) or views[index + 1].light != view.light
            if index == 0 or is_last:
                self._merge.dispatch(
                    commands,
                    (blockers.corners,),
                    params=params,
                    sums=self._sums,
                    merged=blockers.sums,
                )
        blockers.open(commands)
