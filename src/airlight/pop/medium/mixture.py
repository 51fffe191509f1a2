"""All media of a scene as one of them meets them: on ways of light, and in its own box.

Every medium keeps a grid of its own; in it coefficients of all media add up, so that where boxes
overlap each solves for the light of what is really there, and emits what it scatters itself. What
the others scatter outside its box arrives from blocks of them (`given`).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...gpu.device import Gpu
from ...gpu.layout import Struct, f32, mat4x4f, pack_array, vec3f
from ...gpu.memory import Buffer, Texture
from ...gpu.slots import Slot, storage, texture
from ...maths.transforms import F64
from .placement import MediumPlacement, PlacedVolume

PER_AXIS = 3
"""Blocks along each axis of a medium that others take its light from."""
BLOCKS = PER_AXIS**3
_PLACES = 8  # along an axis, where boxes are asked whether they overlap


class MixedData(Struct):
    """A medium as another one, or it itself, meets it."""

    uvw_from_medium = mat4x4f("from the frame of the one that asks to 0..1 in this one's box")
    sigma_t = vec3f("m^-1 at density 1")
    cell = f32("m, the shortest side")
    albedo = vec3f()
    mean_density = f32("over its mass")
    g = vec3f("mean cosine")
    overlap = f32("of the box of the one that asks, the share that lies in this one's")


class Mix:
    """What a solver's passes bind to know the other media; nothing where it is alone."""

    def __init__(self, gpu: Gpu, cells: int, others: int, *, has_blocks: bool = True) -> None:
        """`others`: how many there are; `cells` of the medium's own grid. `has_blocks`: whether
        their light comes in.
        """
        self.media, self.blocks, self.cells = 1 + others, BLOCKS * others * has_blocks, cells
        self.rows = Buffer(gpu, "mixed media", MixedData.dtype.itemsize * self.media)
        self.given = Buffer(gpu, "light of other media", 16 * max(1, cells * self.blocks))
        self._written = b""

    @property
    def is_alone(self) -> bool:
        """Whether there is no other medium."""
        return self.media == 1

    def write(
        self, own: PlacedVolume, others: Sequence[PlacedVolume], *, is_white: bool = False
    ) -> None:
        """Take the media as they are, or as they were if they did not absorb."""
        packed = pack_array(MixedData, [_row(own, of) for of in (own, *others)])
        if is_white:
            packed["albedo"] = 1.0
        if packed.tobytes() != self._written:
            self._written = packed.tobytes()
            self.rows.write(packed)

    @property
    def cell_slots(self) -> tuple[Slot, ...]:
        """Of passes that ask what is in cells."""
        return () if self.is_alone else (storage("media", MixedData),)

    @property
    def cell_wgsl(self) -> str:
        """For them."""
        return _used("one_medium_cells", "mixed_media_cells", self.media)

    @property
    def cell_wgsl_more(self) -> str:
        """After `beam_wgsl`."""
        return f"//! use {'one_medium' if self.is_alone else 'mixed_media'}_cells\n"

    @property
    def cell_bound(self) -> dict[str, Any]:
        """For them, by slot name."""
        return {} if self.is_alone else {"media": self.rows}

    @property
    def beam_slots(self) -> tuple[Slot, ...]:
        """Of passes that ask for beams' light in cells."""
        return () if self.is_alone else (*self.cell_slots, storage("given", "vec4f"))

    def beam_wgsl(self, *, has_blocks: bool) -> str:
        """For them; `has_blocks`: whether the last ordinates are blocks of the others."""
        blocks = f"const BLOCKS = {self.blocks if has_blocks else 0}u;\n"
        both = _used("one_medium_beams", "mixed_media_beams", self.media)
        return both if self.is_alone else blocks + both

    @property
    def beam_bound(self) -> dict[str, Any]:
        """For them, by slot name."""
        return {} if self.is_alone else {"media": self.rows, "given": self.given}


def fine_slots(others: int) -> tuple[Slot, ...]:
    """The densities of the others."""
    return tuple(texture(f"fine{m}", "3d") for m in range(1, 1 + others))


def fine_wgsl(others: int) -> str:
    """`fine_of`, and how many media there are: textures cannot be indexed."""
    cases = "".join(
        f"    if (m == {m}u) {{ rho = textureSampleLevel(fine{m}, linear_clamp, uvw, 0.0).x; }}\n"
        for m in range(1, 1 + others)
    )
    return (
        f"const MEDIA = {1 + others}u;\nfn fine_of(m: u32, uvw: vec3f) -> f32 {{\n"
        f"    var rho = 0.0;\n{cases}    return rho;\n}}\n"
    )


def fine_bound(others: Sequence[Texture]) -> dict[str, Any]:
    """By slot name, of the others' `Density.fine`."""
    return {f"fine{m}": fine for m, fine in enumerate(others, 1)}


def _used(alone: str, mixed: str, media: int) -> str:
    return f"//! use {alone}\n" if media == 1 else f"const MEDIA = {media}u;\n//! use {mixed}\n"


def _row(own: PlacedVolume, of: PlacedVolume) -> dict[str, Any]:
    volume, placement = of.volume, of.placement
    uvw_from_own = placement.uvw_from_world @ own.placement.world_from_medium
    return {
        "uvw_from_medium": uvw_from_own,
        "sigma_t": of.extinction,
        "cell": float(np.min(placement.cell)),
        "albedo": volume.albedo,
        "mean_density": of.width.density,
        "g": volume.g,
        "overlap": _overlap(uvw_from_own, own.placement),
    }


def _overlap(uvw_from_own: F64, own: MediumPlacement) -> float:
    """The share of a medium's box that lies in another's."""
    at = (np.arange(_PLACES) + 0.5) / _PLACES
    places = np.stack(np.meshgrid(at, at, at), axis=-1).reshape(-1, 3) * own.extent
    uvw = places @ uvw_from_own[:3, :3].T + uvw_from_own[:3, 3]
    return float(np.all((uvw > 0.0) & (uvw < 1.0), axis=-1).mean())
