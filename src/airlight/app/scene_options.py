"""Options that say which scene a command takes, how it is read and lit, and by which camera."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from .options import Decorator, Number, together

if TYPE_CHECKING:
    from ..scene.scene import Scene


def scene_options() -> Decorator:
    """SCENE, and how it is read and lit, given as `scene` and `model`; for commands that show it.

    To `model_options` this adds --sun and --ground.
    """
    return together(click.argument("scene"), model_options(), sun_option(), _ground_option())


def model_options() -> Decorator:
    """--up, --scale and --variant of a model, --param of a Mitsuba file; the command gets `model`,
    {name: value}, of what was given."""
    return together(
        click.option(
            "--up",
            type=click.Choice(["y", "z"]),
            callback=_model,
            expose_value=False,
            help="Of a mesh file or grid: the axis that points upwards.  [default: y]",
        ),
        click.option(
            "--scale",
            type=Number(min=0.0, min_open=True, max=1e9),
            metavar="METRES",
            callback=_model,
            expose_value=False,
            help="Of a mesh file or grid: how long its unit is, .001 for millimetres; a grid's "
            "coefficients stay per metre.  [default: 1]",
        ),
        click.option(
            "--variant",
            metavar="NAME",
            callback=_model,
            expose_value=False,
            help="Of a glTF file: which of its material variants; `airlight info` lists them.",
        ),
        click.option(
            "--param",
            "parameters",
            multiple=True,
            metavar="NAME=VALUE",
            callback=_parameters,
            expose_value=False,
            help="Of a Mitsuba file: what $NAME stands for, as Mitsuba's -D; may be repeated.",
        ),
    )


def sun_option() -> Decorator:
    """--sun, among what `model` says."""
    return click.option(
        "--sun",
        metavar="WHERE",
        callback=_sun,
        expose_value=False,
        help="A clear sky with its sun instead of the scene's: ELEVATION,AZIMUTH in degrees, or "
        "TIME@LATITUDE,LONGITUDE, such as 2026-06-21T17:30+02:00@48.1,11.6; a third number is the "
        "turbidity.",
    )


def _ground_option() -> Decorator:
    return click.option(
        "--ground/--no-ground",
        default=None,
        callback=_ground,
        expose_value=False,
        help="Whether a mesh file or grid that airlight lights stands on a ground.  "
        "[default: mesh files do]",
    )


def camera_options() -> Decorator:
    """--aperture, --focus and --shutter; the command gets `camera`, {field: value}, what of them
    was given."""
    return together(
        click.option(
            "--aperture",
            "aperture_m",
            type=Number(min=0.0, max=1e6),
            metavar="METRES",
            callback=_camera,
            expose_value=False,
            help="Diameter of the camera's lens, .05 for a large one.  [default: the scene's]",
        ),
        click.option(
            "--focus",
            "focus_m",
            type=Number(min=1e-6, max=1e9),
            metavar="METRES",
            callback=_camera,
            expose_value=False,
            help="How far ahead things are sharp.  [default: the scene's, or its target]",
        ),
        click.option(
            "--shutter",
            "shutter_s",
            type=Number(min=0.0, max=1e6),
            metavar="SECONDS",
            callback=_camera,
            expose_value=False,
            help="How long a frame's shutter is open while things move.  [default: the scene's]",
        ),
    )


def with_camera(scene: Scene, changes: Mapping[str, Any]) -> Scene:
    """The scene with what `camera_options` gave its camera; warnings tell what does nothing."""
    if not changes:
        return scene
    camera = replace(scene.camera, **changes)
    # Options that need others say what they lack.
    told = []
    if "focus_m" in changes and camera.aperture_m == 0.0:
        told.append("--focus does nothing without a lens: give it an --aperture")
    if changes.get("shutter_s") and scene.animation is None:
        told.append("--shutter does nothing, as nothing moves")
    return replace(scene, camera=camera, warnings=(*scene.warnings, *told))


def with_exposure(scene: Scene, exposure: float | str | None) -> Scene:
    """The scene with the exposure that --exposure gives its camera; None: its own."""
    if exposure is None:
        return scene
    stops = None if isinstance(exposure, str) else exposure
    return replace(scene, camera=replace(scene.camera, exposure_stops=stops))


def _camera(ctx: click.Context, param: click.Parameter, value: float | None) -> None:
    camera: dict[str, Any] = ctx.params.setdefault("camera", {})
    if value is not None:
        camera[str(param.name)] = value


def _model(ctx: click.Context, param: click.Parameter, value: Any) -> None:
    model: dict[str, Any] = ctx.params.setdefault("model", {})
    if value is not None:
        model[str(param.name)] = value


def _parameters(ctx: click.Context, param: click.Parameter, texts: tuple[str, ...]) -> None:
    """The last value of a name holds. None of them is no option that a file could refuse."""
    found: dict[str, str] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or not name.strip():
            raise click.BadParameter(f"'{text}' is not written as name=value")
        found[name.strip()] = value.strip()
    _model(ctx, param, found or None)


def _ground(ctx: click.Context, param: click.Parameter, value: bool | None) -> None:
    # None is a choice of its own: where a ground belongs.
    ctx.params.setdefault("model", {})["ground"] = value


def _sun(ctx: click.Context, param: click.Parameter, value: str | None) -> None:
    if value is not None:
        from ..scene.sun_sky import sky_of_text

        sky_of_text(value)  # refused before anything is loaded
    _model(ctx, param, value)
