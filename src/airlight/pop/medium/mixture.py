"""Coefficients and optical depths of all media of a scene, in the frame of one of them.

Every medium keeps a grid of its own. In its cells the coefficients of all media add up, so that
where boxes overlap each medium solves for the light of all that is there, and emits what it
scatters itself. What the others scatter outside its box arrives as inter-medium irradiance
(`exchange`).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ...gpu.device import Gpu
from ...gpu.layout import Struct, f32, mat4x4f, pack_array, vec3f
from ...gpu.memory import Buffer, Texture
from ...gpu.rows import Table, table
from ...gpu.slots import Slot, storage, texture
from ...maths.transforms import F64, placed_points
from .placement import MediumPlacement, PlacedVolume

BLOCKS_PER_AXIS = 3
"""Blocks along each axis of a medium, as which others receive its light."""
BLOCKS = BLOCKS_PER_AXIS**3
_OVERLAP_SAMPLES = 8  # along an axis


class MixedData(Struct):
    """A medium in the frame of another one, or in its own."""

    uvw_from_medium = mat4x4f("from the frame of the solved medium to 0..1 in this one's box")
    sigma_t = vec3f("m^-1 at density 1")
    cell = f32("m, the shortest side")
    albedo = vec3f()
    mean_density = f32("weighted by mass")
    g = vec3f("mean cosine")
    overlap = f32("share of the solved medium's box that lies in this one's")


class MediaCount(NamedTuple):
    """How many `own` parts a medium has, how many `others` there are, and all parts of those."""

    own: int = 1
    others: int = 0
    other_parts: int = 0

    @property
    def rows(self) -> int:
        """All parts of all media."""
        return self.own + self.other_parts


class Mixture:
    """The table of all media that the passes of one medium bind; nothing where it is alone.

    `rows`: MixedData, the medium's own parts first. `inter_medium`: vec4f [block][cell], the
    irradiance that arrives from every block of the others. `blocks`: how many there are.
    """

    def __init__(self, gpu: Gpu, cells: int, count: MediaCount, *, has_blocks: bool = True) -> None:
        """For a grid of `cells`; the light of the other media arrives if it `has_blocks`."""
        self.count, self.cells = count, cells
        self.media, self.blocks = count.rows, BLOCKS * count.others * has_blocks
        self.rows = Table(gpu, "mixed media", MixedData, self.media)
        # A buffer may not be empty.
        nbytes = 16 * max(1, cells * self.blocks)
        self.inter_medium = Buffer(gpu, "inter-medium irradiance", nbytes)
        self._written = b""

    @property
    def is_alone(self) -> bool:
        """Whether there is no other medium."""
        return self.media == 1

    def write(self, parts: Sequence[PlacedVolume], *, is_white: bool = False) -> None:
        """Upload the media as they are, the own parts first; without absorption if `is_white`."""
        packed = pack_array(MixedData, [_row(parts[0], part) for part in parts])
        # In the furnace nothing is absorbed, and radiance 1 comes back everywhere.
        if is_white:
            packed["albedo"] = 1.0
        if packed.tobytes() != self._written:
            self._written = packed.tobytes()
            self.rows.write(packed)

    @property
    def cell_slots(self) -> tuple[Slot, ...]:
        """Slots of passes that read the coefficients of cells."""
        return () if self.is_alone else (table("media", MixedData),)

    @property
    def cell_wgsl(self) -> str:
        """WGSL before such a pass."""
        return _used("one_medium_cells", "mixed_media_cells", self.count)

    @property
    def cell_wgsl_after_beams(self) -> str:
        """The same where `beam_wgsl` stands before it."""
        return f"//! use {'one_medium' if self.is_alone else 'mixed_media'}_cells\n"

    @property
    def cell_bound(self) -> dict[str, Any]:
        """Resources of such a pass, by slot name."""
        return {} if self.is_alone else {"media": self.rows}

    @property
    def beam_slots(self) -> tuple[Slot, ...]:
        """Slots of passes that read the light of beams in cells."""
        return () if self.is_alone else (*self.cell_slots, storage("inter_medium", "vec4f"))

    def beam_wgsl(self, *, has_blocks: bool) -> str:
        """WGSL before such a pass; `has_blocks`: the last ordinates are blocks of the others."""
        blocks = f"const BLOCKS = {self.blocks if has_blocks else 0}u;\n"
        both = _used("one_medium_beams", "mixed_media_beams", self.count)
        return both if self.is_alone else blocks + both

    @property
    def beam_bound(self) -> dict[str, Any]:
        """Resources of such a pass, by slot name."""
        return {} if self.is_alone else {"media": self.rows, "inter_medium": self.inter_medium}


def fine_slots(others: int) -> tuple[Slot, ...]:
    """Slots for the fine densities of the other media."""
    return tuple(texture(f"fine{m}", "3d") for m in range(1, 1 + others))


def fine_wgsl(others: int) -> str:
    """MEDIA and `fine_of`, the density of medium m: WGSL cannot index textures."""
    cases = "".join(
        f"    if (m == {m}u) {{ rho = textureSampleLevel(fine{m}, linear_clamp, uvw, 0.0).x; }}\n"
        for m in range(1, 1 + others)
    )
    return (
        f"const MEDIA = {1 + others}u;\nfn fine_of(m: u32, uvw: vec3f) -> f32 {{\n"
        f"    var rho = 0.0;\n{cases}    return rho;\n}}\n"
    )


def fine_bound(others: Sequence[Texture]) -> dict[str, Any]:
    """The `Density.fine` of the other media, by slot name."""
    return {f"fine{m}": fine for m, fine in enumerate(others, 1)}


def _used(alone: str, mixed: str, count: MediaCount) -> str:
    if count.rows == 1:
        return f"//! use {alone}\n"
    return f"const MEDIA = {count.rows}u;\nconst OWN_PARTS = {count.own}u;\n//! use {mixed}\n"


def _row(own: PlacedVolume, other: PlacedVolume) -> dict[str, Any]:
    """The values of MixedData of `other` in the frame of `own`."""
    # Its box as the solved medium's frame sees it.
    volume, placement = other.volume, other.placement
    uvw_from_own = placement.uvw_from_world @ own.placement.world_from_medium
    return {
        "uvw_from_medium": uvw_from_own,
        "sigma_t": other.extinction,
        "cell": float(np.min(placement.cell)),
        "albedo": volume.albedo,
        "mean_density": other.width.density,
        "g": volume.g,
        "overlap": _overlap(uvw_from_own, own.placement),
    }


def _overlap(uvw_from_own: F64, own: MediumPlacement) -> float:
    """The share of a medium's box that lies in another's."""
    # The share of samples in the solved medium's box that lie in the other.
    at = (np.arange(_OVERLAP_SAMPLES) + 0.5) / _OVERLAP_SAMPLES
    samples = np.stack(np.meshgrid(at, at, at), axis=-1).reshape(-1, 3) * own.extent
    uvw = placed_points(samples, uvw_from_own)
    return float(np.all((uvw > 0.0) & (uvw < 1.0), axis=-1).mean())
