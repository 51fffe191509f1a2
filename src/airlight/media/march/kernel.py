"""The variants of the marching kernel, by the fields it marches: parameters, slots and targets.

`kernel_wgsl` generates the functions in which they differ.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

from ...gpu.layout import Struct, f32, i32, mat4x4f, u32, vec3f, vec4u
from ...gpu.slots import Slot, sampler, storage, texture, uniform
from ...lattice.placement import LatticeParams
from ..gpu_media import GpuMedia
from ..rays import RayParams
from .forward_source import forward_slots
from .half_space import half_space_slots

MAX_LEVELS_AT_ONCE = 3
"""Nested lattices that fade into each other at one point."""


class MarchParams(Struct):
    """How rays are cut into steps, and how the lattice is read."""

    step = f32("m")
    max_steps = u32()
    cutoff = f32("transmittance below which a ray ends")
    lattice_scale = f32("W m^-2 sr^-1 per stored unit of a")
    lattice_direct = f32("share of b that the phase function keeps, per g")
    sky_scale = f32("W m^-2 sr^-1 per stored unit of a")
    sky_direct = f32("share of b that the phase function keeps, per g")
    forward_scale = f32("W m^-2 per stored unit of light scattered forwards")
    forward_spread = f32("m^-2, see ForwardSource")
    forward_slabs = f32("lights that its texture holds along z")
    forward_count = u32("of which so many shine")
    half_space_top = f32("m, of an endless medium")
    half_space_sigma_t = f32("m^-1, of an endless medium")
    ahead = vec3f("unit length, where the eye looks that cells scatter towards")


class SourceData(Struct):
    """One source texture; its box is 0..1 on each axis of its own space."""

    uvw_from_world = mat4x4f()
    scale = f32("W m^-3 sr^-1 per stored unit, or W m^-2 sr^-1 before scattering")
    medium = i32("of `fields.Source`: a row of the media, or which of them")
    parts = u32("media from it on that are one volume's")
    steps = f32("length of a step in it, in steps of the finest source")
    members_low = vec4u("bits of media, see wgsl/members.wgsl")
    members_high = vec4u()
    fade_low = vec3f("0..1 in its box, where the light of a finer grid begins")
    fade_low_width = vec3f("to where it is whole")
    fade_high = vec3f("where it ends")
    fade_high_width = vec3f()


LatticeForm = Literal["none", "mean", "two bands", "reduced medium", "in-scattering", "lobes"]
"""What is read of a lattice: means alone, where phase functions are isotropic; both bands; means
that reduced media scatter, with both bands for what they are at the eye; what media scatter towards
the eye; means with the directions of `fields.AirLobes`."""
MEAN_FORMS: tuple[LatticeForm, ...] = ("mean", "reduced medium", "in-scattering", "lobes")
"""Those that read the texture of means."""
LOBE_SLOTS = ["lobe_straight", "lobe_along", "lobe_scattered_along"]
"""The textures of `fields.AirLobes`, of the form "lobes"."""
SkyForm = Literal["none", "mean", "two bands", "three bands"]
"""Likewise; three bands where phase functions are strongly anisotropic."""
Written = Literal["light and transmittance", "light", "transmittance"]


@dataclass(frozen=True)
class Variant:
    """What is marched: source textures, a lattice, the sky's, forward light besides the lattice.

    `fading`: which sources are finer grids inside the next one, () if none is. `levels`: how many
    nested lattices there are at one point. `half_space_side`: directions along a side of the table
    of an endless medium, if any. `is_reduced_medium`: whether the lattice was solved for reduced
    media, through which forward light goes on to the eye. `writes`: what the targets are.
    """

    sources: int = 0
    fading: tuple[bool, ...] = ()
    lattice: LatticeForm = "none"
    sky: SkyForm = "none"
    has_forward: bool = False
    levels: int = 1
    half_space_side: int = 0
    is_reduced_medium: bool = False
    writes: Written = "light and transmittance"

    @property
    def has_lattice(self) -> bool:
        """Whether there is a lattice beside the sky's."""
        return self.lattice != "none"

    @property
    def has_sky(self) -> bool:
        """Whether there is the sky's lattice."""
        return self.sky != "none"


def slots(media: GpuMedia, variant: Variant) -> tuple[Slot, ...]:
    """The slots of the kernel."""
    rays = (uniform("rays", RayParams), texture("picked", "2d", "unfilterable-float"))
    return (*rays, *field_slots(media, variant))


def field_slots(media: GpuMedia, variant: Variant) -> tuple[Slot, ...]:
    """Of those, the ones of media and fields, which passes over rays of their own have, too."""
    # The media, then textures of solvers with grids of their own.
    made = [uniform("march", MarchParams), *media.medium_slots]
    if variant.sources:
        made += [storage("sources", SourceData), sampler("source_linear")]
        made += [texture(f"source{i}", "3d") for i in range(variant.sources)]
    # Lattices, the sky's likewise, and of each what its form reads.
    names: list[str] = []
    if variant.has_lattice or variant.has_sky:
        made += [
            storage("lattices", LatticeParams),
            sampler("linear_clamp"),
        ]
        # A lattice has its radiance by channel, and the walls that no lookup reads through.
        colours = ("red", "green", "blue", "visibility_a", "visibility_b", "walls")
        names += [f"lattice_{name}" for name in colours]
    if variant.has_sky:
        names += [f"sky_{name}" for name in ("red", "green", "blue")]
    # Means or a third band, as the form of reading wants them.
    names += ["lattice_mean"] * (variant.lattice in MEAN_FORMS)
    names += LOBE_SLOTS * (variant.lattice == "lobes")
    names += LOBE_SLOTS[-1:] * (variant.lattice == "in-scattering")
    names += ["sky_mean"] * (variant.sky == "mean")
    names += ["sky_third"] * (variant.sky == "three bands")
    made += [texture(name, "3d") for name in names]
    # What comes beside lattices.
    beams = forward_slots() if variant.has_forward else ()
    beams += half_space_slots() if variant.half_space_side else ()
    return (*made, *beams)


def target_names(variant: Variant) -> list[str]:
    """The targets of the kernel, in their order."""
    # The sky's light is a target of its own: it counts as single scattering.
    light = ["scattered", *["skylit"] * variant.has_sky]
    return {
        "light and transmittance": [*light, "passed"],
        "light": light,
        "transmittance": ["passed"],
    }[variant.writes]


def at_once(variant: Variant, most: int) -> tuple[Variant, ...]:
    """One kernel, or two that share its targets where a pass may have but `most`."""
    # Two kernels march every ray twice, so one is taken where it fits.
    if len(target_names(variant)) <= most or variant.writes != "light and transmittance":
        return (variant,)
    return replace(variant, writes="light"), replace(variant, writes="transmittance")


def firsts(variant: Variant) -> dict[str, tuple[str, ...]]:
    """Tables of which the first row alone is read, and what is not read of it."""
    has_table = variant.has_lattice or variant.has_sky
    return {"lattices": ("power_scale", "lookup_scale", "is_paper")} if has_table else {}
