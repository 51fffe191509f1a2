"""March eye rays through solved in-scattered radiance, front to back.

Source and extinction are constant within a step, the integral over it is exact (Billeter2012
section 4.3; the volume rendering equation of Max 1995). Steps end at the borders of media and
are no longer than the voxels of a grid inside it.

Sources come in two forms: a texture of emission J (W m^-3 sr^-1; or, times the scattering
coefficient of one or all media, of mean radiance), and a solved lattice of two-band states. What
arrives from the sky is a lattice of its own, and an image of its own: light scattered once.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ...fields import HalfSpaceLight, LatticeSource, Source
from ...gpu.commands import Commands
from ...gpu.device import Gpu
from ...gpu.layout import pack_array
from ...gpu.memory import Buffer, Texture, linear_sampler
from ...gpu.raster import FullscreenPass
from ...lattice.placement import Placement
from ...lattice.table import LatticeTable
from ...maths.transforms import F64
from ..gpu_media import GpuMedia
from ..rays import RayParams, Rays
from .cells import MarchCells
from .forward_source import fused_rows
from .kernel import (
    MAX_LEVELS_AT_ONCE,
    MarchParams,
    SourceData,
    Variant,
    at_once,
    firsts,
    generated,
    slots,
    target_names,
)

MAX_SOURCES = 4
_BYTES = 16  # of a pixel of one target
_LIMIT = "max-color-attachment-bytes-per-sample"
_TWO_BANDS = 0.25  # the largest g that two bands are enough for


def placed(placement: Placement) -> F64:
    """(4, 4): the world to a lattice's texture coordinates."""
    extent = placement.cell * np.array(placement.count, np.float64)
    matrix = np.eye(4)
    matrix[:3, :3] = np.array(placement.axes) / extent[:, None]
    matrix[:3, 3] = -np.array(placement.origin) / extent
    return matrix


class _March(FullscreenPass):
    """The kernel for one variant: of pixels, whose triangle carries what all rays ask."""

    file = "march.wgsl"

    def __init__(self, gpu: Gpu, air: GpuMedia, variant: Variant) -> None:
        self.slots = slots(air, variant)  # type: ignore[misc]
        names = target_names(variant)
        self.targets = ("rgba32float",) * len(names)  # type: ignore[misc]
        gpu.require(_LIMIT, _BYTES * len(names), "marching")
        super().__init__(
            gpu, generated=air.medium_wgsl + generated(variant), firsts=firsts(variant)
        )


class March:
    """Scattered radiance and transmittance of every picked ray."""

    def __init__(
        self,
        gpu: Gpu,
        air: GpuMedia,
        *,
        sources: int = 0,
        has_lattice: bool = False,
        has_sky: bool = False,
    ) -> None:
        """What `encode` will be given; kernels are made when what they are for first comes."""
        self.gpu, self._air, self._linear = gpu, air, linear_sampler(gpu)
        self._table = Buffer(gpu, "sources", SourceData.dtype.itemsize * max(1, sources))
        self._written = b""
        self._lattices: LatticeTable | None = None
        self._cells = MarchCells(gpu)
        self.params: MarchParams | None = None  # the last ones
        self._variant = Variant(sources, has_lattice, has_sky)
        self._passes: dict[Variant, _March] = {}
        self._fused: Buffer | None = None
        self._fused_of: tuple[Any, ...] = ()

    def encode(
        self,
        commands: Commands,
        params: RayParams,
        rays: Rays,
        *,
        sources: Sequence[Source] = (),
        lattice: LatticeSource | None = None,
        sky: LatticeSource | None = None,
        far: HalfSpaceLight | None = None,
        scattered: Texture,
        transmittance: Texture | None = None,
        skylit: Texture | None = None,
        steps_per_cell: float = 1.0,
        max_steps: int = 128,
        cutoff: float = 1e-3,
    ) -> None:
        """Fill `scattered`, from `sky` `skylit`, and `transmittance` where it is asked for.

        They are targets, of `rays.reduced` size.
        """
        variant = replace(
            self._chosen(lattice, sky),
            far_side=far.side if far else 0,
            has_passed=transmittance is not None,
        )
        cells = [s.cell_m for s in (*sources, lattice, sky) if s is not None]
        forward = lattice.forward if lattice else None
        bound = self._bound(variant, sources, lattice, sky)
        one = lattice or sky
        if one is not None:  # nested lattices are read as they are
            bound["march_cells"] = self._cells.texture
            if variant.levels == 1:
                bound["march_cells"] = self._cells.encode(commands, one.placement.count, bound)
        self.params = MarchParams(
            step=min(cells, default=math.inf) / steps_per_cell if cells else 1e9,
            max_steps=max_steps,
            cutoff=cutoff,
            lattice_scale=lattice.scale if lattice else 0.0,
            lattice_direct=lattice.direct if lattice else 0.0,
            sky_scale=sky.scale if sky else 0.0,
            sky_direct=sky.direct if sky else 0.0,
            forward_scale=forward.scale if forward else 0.0,
            forward_spread=forward.spread if forward else 0.0,
            forward_slabs=forward.slabs if forward else 1.0,
            forward_count=forward.count if forward else 0,
            half_space_top=far.top if far else 0.0,
            half_space_sigma_t=far.sigma_t if far else 1.0,
        )
        targets = {"scattered": scattered, "skylit": skylit, "passed": transmittance}
        for part in at_once(variant, self.gpu.limits[_LIMIT] // _BYTES):
            self._pass(part).draw(
                commands,
                tuple(targets[name] for name in target_names(part)),
                rays=params,
                march=self.params,
                picked=rays.picked,
                **self._air.medium_bound,
                **bound,
                **({"half_space": far.table} if far else {}),
            )

    def _pass(self, variant: Variant) -> _March:
        if variant not in self._passes:
            self._passes[variant] = _March(self.gpu, self._air, variant)
        return self._passes[variant]

    def _chosen(self, lattice: LatticeSource | None, sky: LatticeSource | None) -> Variant:
        """Loops and reads that a lattice and its air do not need are left out: they would cost."""
        sharpest = max((abs(c) for row in self._air.rows for c in row["g"]), default=0.0)
        is_even = sharpest == 0.0
        one = sky or lattice
        return replace(
            self._variant,
            is_even=is_even and lattice is not None and lattice.mean is not None,
            is_sky_even=is_even and sky is not None and sky.mean is not None,
            has_third_band=sharpest > _TWO_BANDS and sky is not None and sky.third is not None,
            has_forward=lattice is not None and lattice.forward is not None,
            is_reduced_medium=lattice is not None and lattice.is_reduced_medium,
            levels=min(len(one.levels), MAX_LEVELS_AT_ONCE) if one else 1,
        )

    def _bound(
        self,
        variant: Variant,
        sources: Sequence[Source],
        lattice: LatticeSource | None,
        sky: LatticeSource | None,
    ) -> dict[str, Any]:
        """By slot name, what is marched."""
        values: dict[str, Any] = {}
        if sources:
            self._write(sources)
            values |= {"sources": self._table, "source_linear": self._linear}
            values |= {f"source{i}": s.texture for i, s in enumerate(sources)}
        lattices = [x for x in (lattice, sky) if x is not None]
        for one in lattices:
            values |= {"lattices": self._levels(one.levels), "linear_clamp": self._linear}
            values |= one.bound
        if sky is not None:
            # wgsl/lattice wants a lattice's textures.
            own = {f"lattice_{c}": sky.bound[f"sky_{c}"] for c in ("red", "green", "blue")}
            values = {**own, **values}
        forward = lattice.forward if lattice else None
        if forward is not None:
            values |= {
                "forward_table": forward.table,
                "forward_lights": forward.texture,
                "forward_blurred": forward.blurred,
                "fused": self._fused_rows(),
            }
        if lattice is not None and (variant.is_even or variant.is_reduced_medium):
            values["lattice_mean"] = lattice.mean
        if sky is not None and variant.has_third_band:
            values["sky_third"] = sky.third
        if sky is not None and variant.is_sky_even:
            values["sky_mean"] = sky.mean
        return values

    def _fused_rows(self) -> Buffer:
        key = tuple(tuple(row["g"]) for row in self._air.rows)
        if self._fused is None or key != self._fused_of:
            self._fused_of, rows = key, fused_rows(self._air.rows)
            if self._fused is None:
                self._fused = Buffer(self.gpu, "fused phase functions", rows.nbytes)
            self._fused.write(rows)
        return self._fused

    def _levels(self, levels: tuple[Placement, ...]) -> Buffer:
        if self._lattices is None or self._lattices.count != len(levels):
            if self._lattices is not None:
                self._lattices.buffer.release()
            self._lattices = LatticeTable(self.gpu, len(levels))
        return self._lattices.filled([level.params() for level in levels])

    def _write(self, sources: Sequence[Source]) -> None:
        packed = pack_array(
            SourceData,
            [
                {"uvw_from_world": s.uvw_from_world, "scale": s.scale, "medium": s.medium}
                for s in sources
            ],
        )
        if packed.tobytes() != self._written:
            self._written = packed.tobytes()
            self._table.write(packed)
