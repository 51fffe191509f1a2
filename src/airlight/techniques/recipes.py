"""The techniques, each as a recipe: which solvers see which fields, in which order.

    kit      lights with shadow maps, the sky, lattices with their blockers
    solvers  each adds its fields: irradiance of surfaces, radiance that media scatter
    media    shafts, marching of all fields, compositing; one of the solvers

A recipe takes what a technique is made for and its settings, and returns the technique. It imports
the solvers that it uses itself: an image without media loads no code about media.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from ..errors import SettingsError
from ..fields import Solver
from ..gather.settings import GatherSettings
from ..lighting.cascades import cascades_nest
from ..lighting.kit import Context, Kit, SurfaceSettings, scene_nest
from ..media.settings import MediaSettings
from ..pop.settings import PopSettings
from ..scene.lights import DirectionalLight
from .settings import (
    LpvMarchSettings,
    LpvScatterSettings,
    LpvScatterWithPopSettings,
    LpvTechniqueSettings,
    LpvWithPopSettings,
    PopTechniqueSettings,
    SingleSettings,
    part_of,
)
from .technique import Technique

if TYPE_CHECKING:
    from ..media.media import Media, Solved
    from ..pop.medium.kinds import GridPlan


def direct(context: Context, settings: SurfaceSettings) -> Technique:
    """Direct light: lights with shadow maps, emission and the sky on surfaces.

    There is no indirect light, and there are no media.
    """
    return Technique("direct", Kit(context, settings), views=lambda kit, settings: [])


def lpv(context: Context, settings: LpvTechniqueSettings) -> Technique:
    """Light propagation volumes (Kaplanyan2010): indirect light on surfaces, no media.

    Texels of reflective shadow maps are virtual point lights. Their light enters a lattice in two
    bands of spherical harmonics, propagates to the six neighbours through faces that surfels of
    the scene block, and is read as irradiance; nested lattices follow the camera.
    """
    from ..lpv.solver import LpvSolver

    def views(kit: Kit, settings: LpvTechniqueSettings) -> list[Solver]:
        is_paper = settings.scheme == "paper"  # whose lookup is what it is there to show
        return [] if is_paper else _gathering(kit, settings, bounces=settings.bounces)

    kit = Kit(context, settings, cascades_nest(context.scene, settings))
    return Technique("lpv", kit, [LpvSolver(kit, settings), *views(kit, settings)], views=views)


def _gathering(
    kit: Kit,
    settings: GatherSettings,
    media: Media | None = None,
    *,
    bounces: bool = True,
    sources: int = 0,
) -> list[Solver]:
    """The final gather, through `media`, of `sources` textures of light, where settings want it."""
    scene = kit.context.scene
    has_media = scene.medium is not None or bool(scene.volumes)
    # Rays cannot go through media that nobody has brought to the device.
    if settings.gather == "off" or (has_media and media is None):
        return []
    from ..gather.solver import GatherSolver

    on_device = media.on_device if media and has_media else None
    return [GatherSolver(kit, settings, on_device, bounces=bounces, sources=sources)]


def single(context: Context, settings: SingleSettings) -> Technique:
    """Direct light attenuated by media, and the light that they scatter once towards the eye.

    The in-scattering integral is evaluated over the lit intervals of each view ray, so shadows in
    media are as sharp as the shadow maps.
    """
    from ..media.media import Media

    kit = Kit(context, settings, scene_nest(context.scene, settings, in_medium=True))
    media = Media(kit, part_of(settings, MediaSettings))
    return Technique("single", kit, [media], media=media)


def lpv_march(context: Context, settings: LpvMarchSettings) -> Technique:
    """`lpv`, its lattice marched as if it were lit medium (Billeter2012, Fig. 5); no shafts."""
    return _lpv_in_media("lpv-march", context, settings, shafts="off")


def lpv_sum(context: Context, settings: LpvMarchSettings) -> Technique:
    """The sum of `lpv-march` and `single`: the trivial combination (Billeter2012, Fig. 5)."""
    return _lpv_in_media("lpv-sum", context, settings)


def _lpv_in_media(
    name: str, context: Context, settings: LpvMarchSettings, **changed: Any
) -> Technique:
    from ..lpv.solver import LpvSolver
    from ..media.media import Media

    # The paper's scheme knows no light from one lattice to the next.
    has_outer = settings.scheme != "paper"
    nest = cascades_nest(context.scene, settings, in_medium=True, has_outer=has_outer)
    kit = Kit(context, settings, nest)
    lattice = LpvSolver(kit, settings, is_marched=True)
    drawn = replace(part_of(settings, MediaSettings), **changed)
    media = Media(kit, drawn, is_lattice_marched=True)
    return Technique(name, kit, [lattice, media], media=media)


def lpv_scatter(context: Context, settings: LpvScatterSettings) -> Technique:
    """Multiple scattering on a lattice (Billeter2012), or on nested ones that follow the camera.

    Light that surfaces reflect and light that media scatter enter the same lattice and propagate
    to 26 neighbours, absorbed and scattered on the way, until the field converges. Surfaces read
    its irradiance; view rays march through its mean radiance; single scattering is exact.
    """
    from ..media.media import Media
    from ..scatter.solver import ScatterSolver

    kit = _scattering_kit(context, settings)
    media = Media(kit, part_of(settings, MediaSettings), is_lattice_marched=True, has_multiple=True)
    gathering = _gathering(kit, settings, media if _is_gathered(context, settings) else None)
    scattering = ScatterSolver(
        kit, settings, has_border_light=settings.cascade_light, is_gathered=bool(gathering)
    )
    solvers = [media, scattering, *gathering]
    return Technique("lpv-scatter", kit, solvers, media=media)


def _is_gathered(context: Context, settings: LpvScatterSettings) -> bool:
    """Whether a gather's rays find the light of media in lattices.

    Not in those of the paper; and beyond lattices there is an endless medium's, which they lack.
    """
    medium = context.scene.medium
    is_endless = medium is not None and medium.endless
    is_ours = not settings.scheme.startswith("paper") and settings.single == "gather"
    return is_ours and not is_endless


def pop(context: Context, settings: PopTechniqueSettings) -> Technique:
    """Principal-ordinates propagation in every medium (Elek2014); surfaces gather in stills.

    Each light, and each part of the environment, is a principal ordinate. Its light is attenuated
    on its path, and what it loses diffuses; or, as in the paper, it goes from cell to cell in a
    grid of its own direction. What all send towards the eye is marched from the medium's grid.
    """
    from ..media.media import Media, Solved
    from ..pop.delta_scaling import delta_scaling
    from ..pop.media import EveryMedium, PopMedia
    from ..pop.medium.kinds import grid_plan
    from .beams import forward_solvers

    # Delta scaling: forward peaks sharper than a grid resolves count as unscattered.
    scaled = None if settings.scheme == "paper" else delta_scaling().of
    context = replace(context, scene=scaled(context.scene)) if scaled else context
    # A sky without surfaces to light needs no shadow maps.
    kit = Kit(context, settings if context.scene.meshes else replace(settings, sky_lights=0))
    # Grids of cells would blur what local lights scatter once: shafts draw it.
    is_local = _has_local_shafts(context, settings)
    drawn = _drawn_by_pop(settings, "auto" if is_local else "off")
    every, own = EveryMedium(context.scene), context.scene.medium
    volumes, plan = context.scene.volumes, grid_plan(every(context.scene), settings)
    found = Solved(volumes if own is None else (own, *volumes), is_local)
    media = Media(kit, drawn, sources=plan.sources, has_sky=False, solved=found)
    solved = PopMedia(kit, media.on_device, settings, plan, every, has_local_shafts=is_local)
    layers = partial(_pop_layers, media, ("single_scatter",) if is_local else ())
    gathering = _gathering(kit, settings, media if scaled else None, sources=plan.sources)
    solvers = [media, *forward_solvers(kit, settings), solved, *gathering]
    return Technique("pop", kit, solvers, media=media, scene_filter=scaled, layers=layers)


def _drawn_by_pop(settings: PopTechniqueSettings, shafts: str) -> MediaSettings:
    """How media are drawn, with the names that the settings of `pop` have for it."""
    return MediaSettings(
        shafts=shafts, march_resolution=settings.march, march_steps=settings.march_steps
    )


def _has_local_shafts(context: Context, settings: PopSettings, shafts: str = "auto") -> bool:
    """Whether shafts draw what volumes of principal ordinates scatter once of local lights."""
    has_local = any(not isinstance(x, DirectionalLight) for x in context.scene.lights)
    return has_local and shafts != "off" and settings.scheme != "paper"


def _pop_layers(media: Media, more: tuple[str, ...], view: Any) -> dict[str, Any]:
    """All that media scatter, in one layer: ordinates do not tell the orders apart.

    `more`: what is drawn beside them.
    """
    found = media.layers(view)
    names = {"scattered": "multiple_scatter"} | {
        name: name for name in ("direct", "indirect", "transmittance", *more)
    }
    return {name: found[of] for name, of in names.items()}


def _with_pop(
    context: Context, settings: Any, but: type
) -> tuple[PopSettings, MediaSettings, Solved, GridPlan]:
    """Settings without those of `but`, and what is solved in grids of ordinates, in which ones."""
    from ..media.media import Solved
    from ..pop.medium.kinds import grid_plan

    own, drawn = part_of(settings, PopSettings, but=but), part_of(settings, MediaSettings)
    volumes, is_local = context.scene.volumes, _has_local_shafts(context, own, drawn.shafts)
    return own, drawn, Solved(volumes, is_local), grid_plan(volumes, own)


def lpv_with_pop(context: Context, settings: LpvWithPopSettings) -> Technique:
    """`lpv` on surfaces, principal ordinates in the volumes between them.

    The volumes attenuate and block the lattice's light and send their own into it; the lattice's
    light is one of the sources that illuminate them.
    """
    from ..lpv.solver import LpvSolver
    from ..media.media import Media
    from ..pop.media import PopMedia
    from .beams import forward_beams
    from .volumes import LatticeVolumes

    kit = Kit(context, settings, cascades_nest(context.scene, settings, in_medium=True))
    own, drawn, found, plan = _with_pop(context, settings, LpvMarchSettings)
    media = Media(kit, drawn, sources=plan.sources, solved=found)
    lattice = LpvSolver(kit, settings)
    beams = forward_beams(kit, own, is_paper=settings.scheme == "paper")
    lattice.media = LatticeVolumes(lattice, media.on_device, plan, own, beams)
    solved = PopMedia(kit, media.on_device, own, plan, has_local_shafts=found.has_local_shafts)
    met = media if settings.scheme != "paper" else None
    gathering = _gathering(kit, settings, met, sources=plan.sources, bounces=settings.bounces)
    return Technique("lpv with pop", kit, [lattice, media, solved, *gathering], media=media)


def lpv_scatter_with_pop(context: Context, settings: LpvScatterWithPopSettings) -> Technique:
    """`lpv-scatter` for surfaces and fog, principal ordinates for the volumes in the fog."""
    from ..media.media import Media
    from ..pop.media import PopMedia
    from ..scatter.solver import ScatterSolver
    from .beams import forward_beams

    # Media hand volumes to the ordinates, and march the rest in the lattice.
    kit = _scattering_kit(context, settings)
    own, drawn, found, plan = _with_pop(context, settings, LpvScatterSettings)
    media = Media(
        kit, drawn, sources=plan.sources, solved=found, is_lattice_marched=True, has_multiple=True
    )
    # Surfaces and fog, then volumes, which take the light that surfaces reflect.
    met = media if _is_gathered(context, settings) else None
    gathering = _gathering(kit, settings, met, sources=plan.sources)
    lattice = ScatterSolver(
        kit,
        settings,
        has_volumes=False,
        has_border_light=settings.cascade_light,
        is_gathered=bool(gathering),
        beams=forward_beams(kit, own, is_paper=settings.scheme.startswith("paper")),
    )
    solved = PopMedia(kit, media.on_device, own, plan, has_local_shafts=found.has_local_shafts)
    return Technique("lpv-scatter with pop", kit, [media, lattice, solved, *gathering], media=media)


def _scattering_kit(context: Context, settings: LpvScatterSettings) -> Kit:
    """The kit on lattices over surfaces and medium; their blockers as the setting says.

    Raises SettingsError where more lattices are asked for than the paper's parts know.
    """
    # The paper's blockers and schemes know one lattice; nested ones are ours.
    is_paper = settings.blockers == "maps" or settings.scheme.startswith("paper")
    if is_paper:
        if settings.cascades > 1:
            raise SettingsError(
                f"cascades = {settings.cascades} with blockers = '{settings.blockers}' and "
                f"scheme = '{settings.scheme}': the paper's blockers and schemes have one lattice",
                remedy="Leave out cascades, or blockers and scheme.",
            )
        settings = replace(settings, cascades=1)
    nest = cascades_nest(context.scene, settings, in_medium=True, has_outer=not is_paper)
    # Blockers of the paper come from six maps around the scene.
    if settings.blockers == "maps":
        from ..scatter.map_blockers import MapBlockers

        from_maps = partial(MapBlockers, resolution=settings.blocker_resolution)
        return Kit(context, settings, nest, make_blockers=from_maps)
    return Kit(context, settings, nest)
