"""What each part of the lighting pass binds: its parameters and its slots."""

from __future__ import annotations

from typing import Literal, Protocol

from ..gpu.layout import Struct, f32, mat4x4f, u32, vec2f, vec3f
from ..gpu.slots import Slot, sampler, storage, texture, uniform
from ..lattice.blockers import SURFACE_BLOCKER_SLOTS
from ..lattice.inject import LightAttenuation
from ..lattice.lookup import CHANNEL_SLOTS
from ..lattice.placement import LatticeParams
from ..rays.rays import RAY_SLOTS
from ..surface.hits import PIXELS, Points
from ..surface.light_table import SHADOWED_LIGHT_SLOTS

Part = Literal["whole", "lights", "lattices", "rest", "gathered"]
"""Which light a pass adds up.

whole     all of it
lights    that of lights, emission and background, into one target
rest      the lattices' light, on top of what "lights" wrote into the slot `lit`
lattices  the same, screen-space occluders' radiance replacing the lattice light that they hide
gathered  on top of "lights" what rays gathered, those that smooth surfaces mirror included
"""
AFTER: tuple[Part, ...] = ("lattices", "rest", "gathered")
"""What "lights" comes before, which has all their shadows."""
Gloss = Literal["none", "inline", "listed", "traced"]
"""Who follows smooth surfaces' mirrored rays: nobody; into the lattice the pass or `GlossyPixels`;
the gather."""


class Attenuation(LightAttenuation, Protocol):
    """Media between a light and a surface, as a pass binds them: media.gpu_media.GpuMedia."""

    @property
    def is_one_box(self) -> bool:
        """Whether all there is is one homogeneous box."""


class LightingParams(Struct):
    """The camera and the number of lights.

    The sun's disk: where, the cosine of its angular radius, what it sends to the eye. `horizon`:
    half a row of the environment's map, in heights of the map, 0 where its rows blend everywhere.
    `map_sun_colour`, of luminance 1: that of what in the map is a light, too. `ray_start`:
    how far above surfaces that rays met others start, which look for shadows.
    """

    world_from_clip = mat4x4f()
    eye = vec3f("m")
    light_count = u32()
    size = vec2f("px")
    environment_rotation = f32("rad")
    has_lattice = u32()
    towards_sun = vec3f()
    sun_cosine = f32()
    sun_radiance = vec3f("W m^-2 sr^-1")
    horizon = f32()
    map_sun_colour = vec3f()
    ray_start = f32("m")


NO_SUNS = {"sun_radiance": (0.0, 0.0, 0.0), "map_sun_colour": (0.0, 0.0, 0.0)}
"""Of `LightingParams`, where what is seen must not have the suns that are lights."""

# By what it is for: surfaces, lights, panes, lattices, the list of glossy pixels.
SURFACE_SLOTS = (
    uniform("params", LightingParams),
    PIXELS.slot,
    texture("albedo", "2d", "unfilterable-float"),
    texture("normal", "2d", "unfilterable-float"),
    texture("emission", "2d", "unfilterable-float"),
)
_LIGHT_SLOTS = (
    *SHADOWED_LIGHT_SLOTS,
    texture("environment", "2d"),
    sampler("environment_sampler"),
)
PANE_SLOTS = (
    texture("parallel_panes", "2d-array", "unfilterable-float"),
    texture("local_panes", "2d-array", "unfilterable-float"),
)
LATTICE_SLOTS = (
    storage("lattices", LatticeParams),
    texture("near_field", "2d", "uint"),
    texture("sky_cube", "3d"),
    *CHANNEL_SLOTS,
    *SURFACE_BLOCKER_SLOTS,
    sampler("linear_clamp"),
)
# Glossy pixels, whose number atomics count.
_LISTS = (
    storage("found", "atomic<u32>", "read_write"),
    storage("listed", "vec4u", "read_write"),
)
GATHERED = ("gathered_irradiance", "gathered_sky")
"""What `Gathered` brings, by slot."""
MIRRORED = ("mirrored_light", "mirrored_sky")
"""And where there are smooth surfaces."""


def lighting_slots(
    part: Part,
    attenuation: Attenuation | None = None,
    gloss: Gloss = "none",
    points: Points = PIXELS,
    *,
    has_panes: bool = False,
    is_traced: bool = False,
) -> tuple[Slot, ...]:
    """The slots of a part of lighting, see `Lighting`. `is_traced`: rays look for shadows."""
    # What one part has lit, the next reads; a part binds what it reads, and nothing else.
    is_after = part in AFTER
    has_lattices = part not in ("lights", "gathered")
    gathered = GATHERED + MIRRORED * (gloss == "traced") if part == "gathered" else ()
    return (
        *(points.slot if slot is PIXELS.slot else slot for slot in SURFACE_SLOTS),
        *((texture("lit", "2d", "unfilterable-float"),) if is_after else ()),
        *(LATTICE_SLOTS if has_lattices else ()),
        *(texture(name, "2d", "unfilterable-float") for name in gathered),
        *(() if is_after else (*_LIGHT_SLOTS, *(attenuation.slots if attenuation else ()))),
        *(PANE_SLOTS if has_panes and not is_after else ()),
        *(RAY_SLOTS if is_traced and not is_after else ()),
        *(_LISTS if gloss == "listed" and part != "lights" else ()),
    )
