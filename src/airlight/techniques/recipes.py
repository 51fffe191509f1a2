"""The techniques, each as a recipe: which solvers see which fields, in which order.

    kit      lights with shadow maps, the sky, lattices with blockers
    solvers  each adds its fields: irradiance of surfaces, light that media scatter
    media    shafts and marching of all fields; surfaces are seen through it

A recipe takes what a technique is made for and its settings, and gives the technique. It imports
the solvers that it uses itself: an image without media needs no code about media.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

from ..lighting.kit import Context, Kit, SurfaceSettings, scene_nest
from ..lpv.settings import LpvSettings
from ..media.settings import MediaSettings
from ..pop.settings import PopSettings
from .settings import (
    LpvMarchSettings,
    LpvScatterSettings,
    LpvScatterWithPopSettings,
    LpvWithPopSettings,
    PopTechniqueSettings,
    SingleSettings,
    part_of,
)
from .technique import Technique


def direct(context: Context, settings: SurfaceSettings) -> Technique:
    """Lights with shadows, emission and the sky on surfaces; nothing bounces, no media."""
    return Technique("direct", Kit(context, settings))


def lpv(context: Context, settings: LpvSettings) -> Technique:
    """Light propagation volumes (Kaplanyan2010): light bounces between surfaces; no media."""
    from ..lpv.solver import LpvSolver, cascades_nest

    kit = Kit(context, settings, cascades_nest(context.scene, settings))
    return Technique("lpv", kit, [LpvSolver(kit, settings)])


def single(context: Context, settings: SingleSettings) -> Technique:
    """Direct light through media, and what they scatter once, with sharp shadows."""
    from ..media.media import Media

    kit = Kit(context, settings, scene_nest(context.scene, settings, in_medium=True))
    media = Media(kit, part_of(settings, MediaSettings))
    return Technique("single", kit, [media], media=media)


def lpv_march(context: Context, settings: LpvMarchSettings) -> Technique:
    """`lpv`, and its lattice marched as if it were lit medium (Billeter2012, Fig. 5); no shafts."""
    return _lpv_in_media("lpv-march", context, settings, shafts="off")


def lpv_sum(context: Context, settings: LpvMarchSettings) -> Technique:
    """The sum of `lpv-march` and `single`: the trivial combination (Billeter2012, Fig. 5)."""
    return _lpv_in_media("lpv-sum", context, settings)


def _lpv_in_media(name: str, context: Context, settings: LpvMarchSettings, **air: Any) -> Technique:
    from ..lpv.solver import LpvSolver, cascades_nest
    from ..media.media import Media

    kit = Kit(context, settings, cascades_nest(context.scene, settings, in_medium=True))
    lattice = LpvSolver(kit, settings, is_marched=True)
    drawn = replace(part_of(settings, MediaSettings), **air)
    media = Media(kit, drawn, is_lattice_marched=True)
    return Technique(name, kit, [lattice, media], media=media)


def lpv_scatter(context: Context, settings: LpvScatterSettings) -> Technique:
    """Multiple scattering on one lattice (Billeter2012): reflected and scattered light together."""
    from ..media.media import Media
    from ..scatter.solver import ScatterSolver

    kit = _scattering_kit(context, settings)
    media = Media(kit, part_of(settings, MediaSettings), is_lattice_marched=True, has_multiple=True)
    lattice = ScatterSolver(kit, settings)
    return Technique("lpv-scatter", kit, [media, lattice], media=media)


def pop(context: Context, settings: PopTechniqueSettings) -> Technique:
    """Principal ordinates for every medium (Elek2014); surfaces are lit directly."""
    from ..media.media import Media
    from ..pop.delta_scaling import DeltaScaling
    from ..pop.media import EveryMedium, PopMedia

    scaling = DeltaScaling()
    scene_filter = (lambda scene: scene) if settings.scheme == "paper" else scaling.scaled
    context = replace(context, scene=scene_filter(context.scene))
    # A sky that lights no surface is not worth its maps.
    kit = Kit(context, settings if context.scene.meshes else replace(settings, sky_lights=0))
    air = MediaSettings(
        shafts="off", march_resolution=settings.march, march_steps=settings.march_steps
    )
    every = EveryMedium(context.scene)
    media = Media(
        kit, air, sources=len(every(context.scene)), has_sky=False, solved=context.scene.volumes
    )
    solved = PopMedia(kit, media.on_device, settings, every)

    def layers(view: Any) -> dict[str, Any]:
        found = media.layers(view)
        return {
            "direct": found["direct"],
            "indirect": found["indirect"],
            "scattered": found["multiple_scatter"],
            "transmittance": found["transmittance"],
        }

    return Technique(
        "pop", kit, [media, solved], media=media, scene_filter=scene_filter, layers=layers
    )


def lpv_with_pop(context: Context, settings: LpvWithPopSettings) -> Technique:
    """`lpv` among volumes: they attenuate and add to its lattice, which lights them in turn."""
    from ..lpv.solver import LpvSolver, cascades_nest
    from ..media.media import Media
    from ..pop.media import PopMedia
    from .volumes import LatticeVolumes

    kit = Kit(context, settings, cascades_nest(context.scene, settings, in_medium=True))
    volumes = context.scene.volumes
    media = Media(kit, part_of(settings, MediaSettings), sources=len(volumes), solved=volumes)
    lattice = LpvSolver(kit, settings)
    lattice.media = LatticeVolumes(lattice, media.on_device)
    solved = PopMedia(kit, media.on_device, part_of(settings, PopSettings, but=LpvMarchSettings))
    return Technique("lpv with pop", kit, [lattice, media, solved], media=media)


def lpv_scatter_with_pop(context: Context, settings: LpvScatterWithPopSettings) -> Technique:
    """`lpv-scatter` for surfaces and fog, principal ordinates for the volumes in it."""
    from ..media.media import Media
    from ..pop.media import PopMedia
    from ..scatter.solver import ScatterSolver

    kit = _scattering_kit(context, settings)
    volumes = context.scene.volumes
    media = Media(
        kit,
        part_of(settings, MediaSettings),
        sources=len(volumes),
        solved=volumes,
        is_lattice_marched=True,
        has_multiple=True,
    )
    lattice = ScatterSolver(kit, settings, has_volumes=False)
    solved = PopMedia(kit, media.on_device, part_of(settings, PopSettings, but=LpvScatterSettings))
    return Technique("lpv-scatter with pop", kit, [media, lattice, solved], media=media)


def _scattering_kit(context: Context, settings: LpvScatterSettings) -> Kit:
    nest = scene_nest(context.scene, settings, in_medium=True)
    if settings.blockers == "maps":
        from ..scatter.map_blockers import MapBlockers

        seen = partial(MapBlockers, resolution=settings.blocker_resolution)
        return Kit(context, settings, nest, make_blockers=seen)
    return Kit(context, settings, nest)
