"""Techniques by name.

direct       lights with shadows, emission and sky; no indirect light, no media
single       direct light through media, and single scattering
lpv          light propagation volumes (Kaplanyan2010); no media
lpv-march    lpv, its lattice marched as if it were lit medium
lpv-sum      the sum of lpv-march and single
lpv-scatter  multiple scattering on a lattice (Billeter2012)
pop          principal-ordinates propagation in every medium (Elek2014)
auto         the recipe that suits the scene

    recipes    which solvers each technique is made of
    technique  how a frame runs through them: solve -> fields -> draw
    beside     another view of what a technique has solved
    settings   the settings of each, joined from its parts
    auto       which recipe suits a scene
    volumes    what volumes do to a lattice of reflected light
    beams      which have beams on surfaces of what volumes only scatter forwards
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from ..errors import SettingsError, nearest
from ..lighting.kit import Context, SurfaceSettings
from ..scene.nearby import Nearby
from ..scene.scene import Scene
from ..scene.settings import make_settings
from . import recipes, settings
from .auto import recipe_for
from .technique import Technique


@dataclass(frozen=True)
class Recipe:
    """How a technique is made, and its settings."""

    make: Callable[[Context, Any], Technique]
    settings: type[SurfaceSettings]


RECIPES: dict[str, Recipe] = {
    "direct": Recipe(recipes.direct, SurfaceSettings),
    "single": Recipe(recipes.single, settings.SingleSettings),
    "lpv": Recipe(recipes.lpv, settings.LpvTechniqueSettings),
    "lpv-march": Recipe(recipes.lpv_march, settings.LpvMarchSettings),
    "lpv-sum": Recipe(recipes.lpv_sum, settings.LpvMarchSettings),
    "lpv-scatter": Recipe(recipes.lpv_scatter, settings.LpvScatterSettings),
    "pop": Recipe(recipes.pop, settings.PopTechniqueSettings),
    "lpv with pop": Recipe(recipes.lpv_with_pop, settings.LpvWithPopSettings),
    "lpv-scatter with pop": Recipe(
        recipes.lpv_scatter_with_pop, settings.LpvScatterWithPopSettings
    ),
}
TECHNIQUES: dict[str, type[SurfaceSettings]] = {
    **{name: recipe.settings for name, recipe in RECIPES.items() if " " not in name},
    "auto": settings.AutoSettings,
}
"""Name -> settings, of every technique that can be asked for."""


def technique_settings(name: str) -> type[SurfaceSettings]:
    """The settings that a technique has in every scene.

    Raises SettingsError for an unknown name, naming the nearest.
    """
    if not isinstance(name, str) or name not in TECHNIQUES:
        raise SettingsError(f"unknown technique '{name}'", remedy=nearest(str(name), TECHNIQUES))
    return TECHNIQUES[name]


def chosen_recipe(name: str, scene: Scene) -> str:
    """The recipe that makes a technique; that of `auto` depends on the scene."""
    technique_settings(name)
    return recipe_for(scene) if name == "auto" else name


def settings_class(name: str, scene: Scene) -> type[SurfaceSettings]:
    """The technique's settings for `scene`; of `auto` those of the recipe that it chooses."""
    return RECIPES[chosen_recipe(name, scene)].settings


def checked_settings(name: str, scene: Scene, given: Mapping[str, Any]) -> Any:
    """The technique's settings for `scene`: the scene file's, then those `given` over them.

    Raises SettingsError for an unknown technique, or for a setting that it does not have, naming
    those that have it.
    """
    chosen = chosen_recipe(name, scene)
    merged, known = {**scene.settings.get(name, {}), **given}, RECIPES[chosen].settings
    where = f"technique {name}" if chosen == name else f"technique {name}, here {chosen}"
    # A name that another technique knows is an error that says whose it is.
    for key in merged:
        if key in known.__dataclass_fields__:
            continue
        having = [other for other, kind in TECHNIQUES.items() if key in kind.__dataclass_fields__]
        if having:
            raise SettingsError(
                f"there is no setting '{key}'",
                where=where,
                remedy=f"{', '.join(having)} {'has' if len(having) == 1 else 'have'} it",
            )
    return make_settings(known, merged, where=where)


def make_technique(
    context: Context, name: str, given: Mapping[str, Any], *, nearby: Nearby | None = None
) -> Technique:
    """The technique `name` for a scene: the scene file's settings, then those `given` over them.

    `nearby`: how the scene was moved from the world, of which settings say. Raises SettingsError
    for an unknown technique or setting.
    """
    made = checked_settings(name, context.scene, given)
    # Settings speak of the world; the scene may have been moved to an origin near it.
    if nearby is not None:
        made = replace(made, bounds=nearby.box(made.bounds))
    return RECIPES[chosen_recipe(name, context.scene)].make(context, made)
