"""Options that say which scene a command takes, how it is read and lit, and by which camera."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..errors import SettingsError
from .options import Decorator, Number, pairs, together

if TYPE_CHECKING:
    from ..scene.scene import Scene


def scene_options() -> Decorator:
    """SCENE, and how it is read and lit, given as `scene` and `model`; for commands that show it.

    Mesh files stand on a ground unless --no-ground is given.
    """
    return together(click.argument("scene"), model_options(stands=True))


def model_options(*, stands: bool = False) -> Decorator:
    """How a file is read and lit: --up and --scale, --grid, --channels, --variant, --param, --sun
    and --ground.

    The command gets `model`, {name: value}, of what was given. `stands`: mesh files get a ground
    unless it is asked for none.
    """
    return together(
        *_file_options(),
        _grouped(
            "model",
            "--sun",
            metavar="WHERE",
            read=_sky_text,
            help="A clear sky with its sun instead of the scene's: ELEVATION,AZIMUTH in degrees, "
            "or TIME@LATITUDE,LONGITUDE, such as 2026-06-21T17:30+02:00@48.1,11.6; a third number "
            "is the turbidity.",
        ),
        click.option(
            "--ground/--no-ground",
            default=None if stands else False,
            callback=_ground,
            expose_value=False,
            help="Whether a mesh file or grid that airlight lights stands on a ground.  "
            f"[default: {'mesh files do' if stands else 'none does'}]",
        ),
    )


def _file_options() -> Iterator[Decorator]:
    yield _grouped(
        "model",
        "--up",
        type=click.Choice(["y", "z"]),
        help="Of a mesh file or grid: the axis that points upwards.  [default: what a grid's axes "
        "say, else y]",
    )
    yield _grouped(
        "model",
        "--scale",
        type=Number(min=0.0, min_open=True, max=1e9),
        metavar="METRES",
        help="Of a mesh file or grid: how long its unit is, .001 for millimetres; a grid's "
        "coefficients stay per metre.  [default: 1]",
    )
    yield _grouped(
        "model",
        "--grid",
        metavar="NAME",
        help="Of a file with several grids: which; NAME[3] is its fourth time.",
    )
    yield _grouped(
        "model",
        "--channels",
        type=click.Choice(["r", "g", "b", "a"]),
        help="Of a grid with several channels: which is the density.",
    )
    yield _grouped(
        "model",
        "--sequence-fps",
        type=Number(1e-3, 1e4),
        metavar="N",
        help="Of grids that follow each other, files or a file's times: how many are shown in a "
        "second.  [default: 24; of NetCDF, zarr and .vti that say when they are 12]",
    )
    yield _grouped(
        "model",
        "--variant",
        metavar="NAME",
        help="Of a glTF file: which of its material variants; `airlight info` lists them.",
    )
    yield _grouped(
        "model",
        "--param",
        "parameters",
        multiple=True,
        metavar="NAME=VALUE",
        # None of them is no option that a file could refuse.
        read=lambda texts: dict(pairs(texts, "name=value")) or None,
        help="Of a Mitsuba file: what $NAME stands for, as Mitsuba's -D; may be repeated.",
    )


def check_model(file: str, model: Mapping[str, Any]) -> None:
    """Refuse options that a kind of file does not know. Raises SceneError, SettingsError."""
    from ..scene.io.images import IMAGE_SUFFIXES
    from ..scene.io.model_options import model_keys

    lit = {name: model[name] for name in ("sun", "ground") if model.get(name)}
    model_keys(file, **{name: model[name] for name in model if name not in ("sun", "ground")})
    if lit and Path(file).suffix.lower() in IMAGE_SUFFIXES:
        raise SettingsError(f"--{next(iter(lit))} is for scenes, and this is an image", where=file)


def camera_options() -> Decorator:
    """--aperture, --focus and --shutter; the command gets `camera`, {field: value}, what of them
    was given."""
    return together(
        _grouped(
            "camera",
            "--aperture",
            "aperture_m",
            type=Number(min=0.0, max=1e6),
            metavar="METRES",
            help="Diameter of the camera's lens, .05 for a large one.  [default: the scene's]",
        ),
        _grouped(
            "camera",
            "--focus",
            "focus_m",
            type=Number(min=1e-6, max=1e9),
            metavar="METRES",
            help="How far ahead things are sharp.  [default: the scene's, or its target]",
        ),
        _grouped(
            "camera",
            "--shutter",
            "shutter_s",
            type=Number(min=0.0, max=1e6),
            metavar="SECONDS",
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


def _grouped(
    group: str, *names: str, read: Callable[[Any], Any] = lambda value: value, **how: Any
) -> Decorator:
    """An option whose value, if one is given, the command gets among those of `group`."""

    def keep(ctx: click.Context, param: click.Parameter, value: Any) -> None:
        kept: dict[str, Any] = ctx.params.setdefault(group, {})
        found = None if value is None else read(value)
        if found is not None:
            kept[str(param.name)] = found

    return click.option(*names, callback=keep, expose_value=False, **how)


def _ground(ctx: click.Context, param: click.Parameter, value: bool | None) -> None:
    # None is a choice of its own: where a ground belongs.
    ctx.params.setdefault("model", {})["ground"] = value


def _sky_text(text: str) -> str:
    """The text, refused before anything is loaded where it is no sky."""
    from ..scene.sun_sky import sky_of_text

    sky_of_text(text)
    return text
