"""March eye rays through solved in-scattered radiance, front to back.

Source and extinction are constant within a step, the integral over it is exact (Billeter2012
section 4.3; the volume rendering equation of Max1995). Steps end at the borders of media and
are no longer than the voxels of a grid inside it.

Sources come in two forms: a texture of emission J (W m^-3 sr^-1; or, times the scattering
coefficient of one or all media, of mean radiance), and a solved lattice of two-band states. The
light of the sky is a lattice of its own, and an image of its own: single scattering.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from ...fields import Source
from ...gpu.commands import Commands
from ...gpu.device import Gpu
from ...gpu.fullscreen import FullscreenPass
from ...gpu.layout import pack_array
from ...gpu.memory import Buffer, Texture, linear_sampler
from ...lattice.placement import Fade, Placement
from ...lattice.table import LatticeTable
from ..gpu_media import GpuMedia
from ..media_rows import member_bits
from ..rays import Rays
from .forward_source import fused_rows
from .kernel import (
    LOBE_SLOTS,
    MEAN_FORMS,
    MarchParams,
    SourceData,
    Variant,
    at_once,
    firsts,
    slots,
    target_names,
)
from .kernel_wgsl import generated
from .marched_light import MarchedLight, variant_of

_BYTES = 16  # of a pixel of one target
_LIMIT = "max-color-attachment-bytes-per-sample"


class _March(FullscreenPass):
    """The kernel for one variant; what all rays read comes as flat interpolants."""

    file = "march.wgsl"

    def __init__(self, gpu: Gpu, media: GpuMedia, variant: Variant) -> None:
        self.slots = slots(media, variant)
        names = target_names(variant)
        self.targets = ("rgba32float",) * len(names)
        gpu.require(_LIMIT, _BYTES * len(names), "marching")
        super().__init__(
            gpu, generated=media.medium_wgsl + generated(variant), firsts=firsts(variant)
        )


@dataclass(frozen=True, eq=False)
class MarchTargets:
    """Textures of the rays' size: `scattered` light, the sky's (`skylit`), and transmittance."""

    scattered: Texture
    transmittance: Texture | None = None
    skylit: Texture | None = None


@dataclass(frozen=True)
class Steps:
    """How many steps a ray takes: `per_cell` of the finest source, at most `most`.

    It ends where its transmittance is `cutoff`.
    """

    per_cell: float = 1.0
    most: int = 128
    cutoff: float = 1e-3


_STEPS = Steps()


class March:
    """Scattered radiance and transmittance of every picked ray."""

    def __init__(
        self,
        gpu: Gpu,
        media: GpuMedia,
        *,
        sources: int = 0,
    ) -> None:
        """`sources`: the most there will be. Kernels are compiled when they are first needed."""
        self.gpu, self._media, self._linear = gpu, media, linear_sampler(gpu)
        self._table = Buffer(gpu, "sources", SourceData.dtype.itemsize * max(1, sources))
        self._written = b""
        self._lattices: LatticeTable | None = None
        self.params: MarchParams | None = None  # the last ones
        self._passes: dict[Variant, _March] = {}
        self._fused: Buffer | None = None
        self._fused_of: tuple[Any, ...] = ()

    def encode(
        self,
        commands: Commands,
        rays: Rays,
        light: MarchedLight,
        targets: MarchTargets,
        steps: Steps = _STEPS,
    ) -> None:
        """Fill the `targets` along `rays`."""
        # The kernel that reads what there is, and no more.
        lattice, sky, far = light.lattice, light.sky, light.half_space
        sharpest = max((abs(c) for row in self._media.rows for c in row["g"]), default=0.0)
        variant = variant_of(light, sharpest)
        if targets.transmittance is None:
            variant = replace(variant, writes="light")
        # Steps are as long as the smallest cells of all that is marched.
        cells = [s.cell_m for s in (*light.sources, lattice, sky) if s is not None]
        bound = self.bound(variant, light)
        self.params = march_params(light, steps, min(cells, default=math.inf))
        # All targets in one pass, or in two where a device has too few.
        textures = {
            "scattered": targets.scattered,
            "skylit": targets.skylit,
            "passed": targets.transmittance,
        }
        for part in at_once(variant, self.gpu.limits[_LIMIT] // _BYTES):
            self._pass(part).draw(
                commands,
                tuple(textures[name] for name in target_names(part)),
                rays=rays.params,
                march=self.params,
                picked=rays.picked,
                **self._media.medium_bound,
                **bound,
                **({"half_space": far.table} if far else {}),
            )

    def _pass(self, variant: Variant) -> _March:
        # A kernel is compiled when its fields are there for the first time.
        if variant not in self._passes:
            self._passes[variant] = _March(self.gpu, self._media, variant)
        return self._passes[variant]

    def bound(self, variant: Variant, light: MarchedLight) -> dict[str, Any]:
        """The resources of the fields, by slot name."""
        sources, lattice, sky = light.sources, light.lattice, light.sky
        # Textures of emission, then lattices, then what comes beside a lattice.
        values: dict[str, Any] = {}
        if sources:
            self._write(sources)
            values |= {"sources": self._table, "source_linear": self._linear}
            values |= {f"source{i}": s.texture for i, s in enumerate(sources)}
        lattices = [x for x in (lattice, sky) if x is not None]
        # Sky and lattice have the same nested levels, so either fills the table.
        for one in lattices:
            values |= {"lattices": self._levels(one.levels), "linear_clamp": self._linear}
            values |= one.bound
        if sky is not None:
            # wgsl/lattice needs the textures of a lattice.
            own = {f"lattice_{c}": sky.bound[f"sky_{c}"] for c in ("red", "green", "blue")}
            values = {**own, **values}
        forward = lattice.forward if lattice else None
        # Unscattered light by lights, sharp and blurred, and the phase functions that scatter it.
        if forward is not None:
            values |= {
                "forward_table": forward.table,
                "forward_lights": forward.texture,
                "forward_blurred": forward.blurred,
                "fused": self._fused_rows(),
            }
        if lattice is not None and variant.lattice in MEAN_FORMS:
            values["lattice_mean"] = lattice.mean
        if lattice is not None and lattice.inscattered:
            values[LOBE_SLOTS[-1]] = lattice.inscattered.along
        if sky is not None and variant.sky == "three bands":
            values["sky_third"] = sky.third
        if sky is not None and variant.sky == "mean":
            values["sky_mean"] = sky.mean
        return values

    def _fused_rows(self) -> Buffer:
        # Phase functions are tabulated for the mean cosines that the media have.
        key = tuple(tuple(row["g"]) for row in self._media.rows)
        if self._fused is None or key != self._fused_of:
            self._fused_of, rows = key, fused_rows(self._media.rows)
            if self._fused is None:
                self._fused = Buffer(self.gpu, "fused phase functions", rows.nbytes)
            self._fused.write(rows)
        return self._fused

    def _levels(self, levels: tuple[Placement, ...]) -> Buffer:
        # Another number of nested levels needs another table.
        if self._lattices is None or self._lattices.count != len(levels):
            if self._lattices is not None:
                self._lattices.buffer.release()
            self._lattices = LatticeTable(self.gpu, len(levels))
        return self._lattices.filled([level.params() for level in levels])

    def _write(self, sources: Sequence[Source]) -> None:
        # Steps are counted in cells of the finest source; where only coarser ones lie, they grow.
        finest = min(s.cell_m for s in sources)
        packed = pack_array(
            SourceData,
            [
                {
                    "uvw_from_world": s.uvw_from_world,
                    "scale": s.scale,
                    "medium": s.medium,
                    "parts": s.parts,
                    **member_bits(s.members),
                    "steps": s.cell_m / finest,
                    **_fade_fields(s.fade),
                }
                for s in sources
            ],
        )
        # Sources that stay as they were are not uploaded again.
        if packed.tobytes() != self._written:
            self._written = packed.tobytes()
            self._table.write(packed)


def _fade_fields(fade: Fade | None) -> dict[str, Any]:
    """The values of `SourceData` of a finer grid."""
    names = ("low", "low_width", "high", "high_width")
    none = (0.0, 0.0, 0.0)
    return {f"fade_{name}": getattr(fade, name) if fade else none for name in names}


def march_params(light: MarchedLight, steps: Steps, cell: float) -> MarchParams:
    """Of rays through `light`.

    `cell`: m, the shortest of all that is marched; infinite where nothing is.
    """
    # What there is not counts nothing, and is one long step.
    lattice, sky, far = light.lattice, light.sky, light.half_space
    forward = lattice.forward if lattice else None
    seen = lattice.inscattered if lattice else None
    return MarchParams(
        step=cell / steps.per_cell if math.isfinite(cell) else 1e9,
        max_steps=steps.most,
        cutoff=steps.cutoff,
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
        ahead=seen.ahead.tolist() if seen else (0.0, 0.0, 0.0),
    )
