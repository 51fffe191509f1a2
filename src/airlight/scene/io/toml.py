"""Read a scene file, version 1 (TOML).

`toml_tables` says what may stand in one; docs/scene-file.md is printed from it.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from ...errors import SceneError, nearest
from ..animation import Track
from ..animation.density import VolumeTrack
from ..animation.tracks import CameraTrack, Curves, EnvironmentTrack, LightTrack
from ..camera import Camera
from ..environment import Environment
from ..lights import TYPES, Light
from ..medium import Medium
from ..scene import Scene
from ..studio import NAME as STUDIO
from ..studio import studio
from .defaults import with_default_camera, with_default_lights
from .files import read_text
from .light_groups import is_group, light_groups
from .toml_animation import animation, shifted, take_keys, with_curves
from .toml_media_tables import MEDIUM
from .toml_meshes import existing_file, placed_mesh
from .toml_schema import check_table, inside
from .toml_sky import read_sky, under
from .toml_tables import CAMERA, ENVIRONMENT, LIGHT, MESH, TABLES
from .toml_volumes import placed_volume, with_extinction

Raw = Mapping[str, Any]
MOST_KEY_PARTS = 32
"""Parts of a dotted key; reading it takes the square of their number."""
_KEY_PART = r"""(?:[\w-]++|"[^"\n]*"|'[^'\n]*')[ \t]*+\.[ \t]*+"""
_LONG_KEY = re.compile(rf"(?<![\w.-])(?:{_KEY_PART}){{{MOST_KEY_PARTS}}}")


def load_toml(path: str | Path) -> Scene:
    """The scene that a TOML scene file describes; paths in it are relative to it.

    Raises SceneError naming the file, the key path and the remedy.
    """
    path = Path(path)
    raw = _parsed(path)
    try:
        _check_names(raw)
        return _scene(raw, path)
    except SceneError as error:
        if error.where:  # a file that the scene file names has said where it is wrong
            raise
        raise SceneError(error.problem, where=path, remedy=error.remedy) from None


def _parsed(path: Path) -> dict[str, Any]:
    # The standard library's reader takes time by the square of a dotted key's parts.
    text = read_text(path)
    long = _LONG_KEY.search(text)
    if long:
        line = text.count("\n", 0, long.start()) + 1
        raise SceneError(f"a key of more than {MOST_KEY_PARTS} parts", where=f"{path}:{line}")
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise SceneError("is nested too deeply", where=path) from None
    except tomllib.TOMLDecodeError as error:
        # The place of the error is in the message alone.
        at = re.fullmatch(r"(.*) \(at line (\d+), column (\d+)\)", str(error), re.DOTALL)
        where = f"{path}:{at[2]}:{at[3]}" if at else str(path)
        problem = at[1] if at else str(error)
        raise SceneError(f"is not TOML: {problem}", where=where) from None
    except ValueError as error:  # a number with more digits than Python reads
        raise SceneError(f"is not TOML: {error}", where=path) from None


def _check_names(raw: Raw) -> None:
    """Refuse tables that do not exist, and [one] for [[many]] or the reverse."""
    headers = {table.name: table for table in TABLES}
    known = [*headers, "technique"]
    # A table has to be known, and written once or many times as its description says.
    for name, value in raw.items():
        if name not in known:
            kind = "table" if isinstance(value, (dict, list)) else "key outside any table,"
            raise SceneError(f"unknown {kind} '{name}'", remedy=nearest(name, known))
        table = headers.get(name)
        if table is not None and table.repeated != isinstance(value, list):
            raise SceneError(f"'{name}' must be written as a {table.header} table")


def _scene(raw: Raw, path: Path) -> Scene:
    # Tables, each with what moves it.
    folder, (camera, seen) = path.parent, _camera(raw)
    parts = [_part(table, label, folder) for label, table in _numbered(raw, "mesh")]
    volumes = [placed_volume(table, label, folder) for label, table in _numbered(raw, "volume")]
    shining = list(_numbered(raw, "light"))
    lights = [_light(table, label) for label, table in shining if not is_group(table)]
    said: list[str] = []
    # Lights of the tables come first, then those of mesh files, as the tracks count them.
    shine = (*(light for light, _ in lights), *(x for part in parts for x in part.lights))
    environment, turning = _environment(raw, folder, shine, said)
    sky = read_sky(raw)
    # Everything that moves, by its number in the scene.
    tracks = [
        *_part_tracks(parts, len(lights), has_camera=camera is not None),
        *([CameraTrack(seen)] if seen else []),
        *(LightTrack(k, moved) for k, (_, moved) in enumerate(lights) if moved),
        *([EnvironmentTrack(turning)] if turning else []),
        *(VolumeTrack(k, files) for k, (_, _, files) in enumerate(volumes) if files),
    ]
    scene = Scene(
        meshes=tuple(mesh for part in parts for mesh in part.meshes),
        lights=shine,
        environment=environment,
        medium=_medium(raw),
        volumes=tuple(volume for volume, _, _ in volumes),
        settings=_technique_settings(raw),
        name=path.stem,
        warnings=(
            *(warning for part in parts for warning in part.warnings),
            *(warning for _, warnings, _ in volumes for warning in warnings),
            *said,
        ),
        animation=animation(raw, tracks),
        light_groups=light_groups(shining, folder),
    )
    # Sky, camera and default light depend on what the scene holds.
    if not (scene.meshes or scene.volumes or scene.medium):
        raise SceneError("there is nothing to see: no [[mesh]], [[volume]] or [medium]")
    is_exposed = "exposure_stops" in raw.get("camera", ())
    framed = _with_camera(under(scene, sky), camera, parts)
    if sky is not None and not is_exposed:
        framed = replace(framed, camera=replace(framed.camera, exposure_stops=None))
    return with_default_lights(framed, is_scene_file=True, is_exposed=is_exposed)


def _part(raw: Any, label: str, folder: Path) -> Scene:
    table, keys = take_keys(raw, label)
    return placed_mesh(check_table(MESH, table, label), label, folder, keys)


def _part_tracks(parts: list[Scene], lights: int, *, has_camera: bool) -> Iterator[Track]:
    """What moves in the parts, once they stand one after the other behind `lights` others.

    The first part with a camera brings the scene's where the file itself has none.
    """
    meshes = 0
    for part in parts:
        # Its meshes and lights are counted behind those of the parts before it.
        for track in part.animation.tracks if part.animation else ():
            yield shifted(track, meshes, lights, has_camera=has_camera)
        meshes, lights = meshes + len(part.meshes), lights + len(part.lights)
        has_camera = has_camera or part.camera != Camera()


def _numbered(raw: Raw, name: str) -> Iterator[tuple[str, Any]]:
    """(key path, table) of every [[name]], counted from 1."""
    for number, table in enumerate(raw.get(name, ()), start=1):
        yield f"[[{name}]] {number}", table


def _camera(raw: Raw) -> tuple[Camera | None, Curves]:
    """[camera] and its keyframes."""
    label = CAMERA.header
    if "camera" not in raw:
        return None, {}
    values, seen = with_curves(CAMERA, raw["camera"], label)
    with inside(label):
        return Camera(**values), seen


def _light(raw: Any, label: str) -> tuple[Light, Curves]:
    values, moved = with_curves(LIGHT, raw, label)
    with inside(label):
        return TYPES[values.pop("type")](**values), moved


def _environment(
    raw: Raw, folder: Path, lights: Sequence[Light], said: list[str]
) -> tuple[Environment | None, Curves]:
    """[environment] and its keyframes; what its file left to doubt is added to `said`.

    `lights` are the scene's, which a studio belongs to.
    """
    label = ENVIRONMENT.header
    if "environment" not in raw:
        return None, {}
    # Its values, and their keyframes.
    values, moved = with_curves(ENVIRONMENT, raw["environment"], label)
    if "file" in values and "radiance" in values:
        raise SceneError(f"{label} has both a file and a radiance", remedy="Use one of them.")
    # A studio, a map from a file, or one radiance.
    with inside(label):
        if values.get("file") == STUDIO:
            del values["file"]
            return replace(studio(lights), **values), moved
        if "file" in values:
            from .images import read_radiance

            written = values.pop("file")
            values["map"] = read_radiance(existing_file(written, label, folder), said)
            values["source"] = written
        return Environment(**values), moved


def _medium(raw: Raw) -> Medium | None:
    label = MEDIUM.header
    if "medium" not in raw:
        return None
    values = check_table(MEDIUM, raw["medium"], label)
    with inside(label):
        return Medium(**with_extinction(values, label))


def _technique_settings(raw: Raw) -> dict[str, dict[str, Any]]:
    """What stands under each [technique.NAME], unchecked until the technique is known."""
    tables = raw.get("technique", {})
    if not isinstance(tables, dict):
        raise SceneError("'technique' must be written as [technique.NAME] tables")
    for name, table in tables.items():
        if not isinstance(table, dict):
            raise SceneError(
                f"[technique]: {name} stands outside a technique's table",
                remedy=f"Write it under [technique.NAME], such as [technique.lpv] {name} = ...",
            )
    return tables


def _with_camera(scene: Scene, camera: Camera | None, parts: list[Scene]) -> Scene:
    """The scene with `camera`, else the first that a mesh file brought, else one that frames it."""
    # A camera like the default one is how a mesh file's scene says that it has none.
    brought = [part.camera for part in parts if part.camera != Camera()]
    chosen = camera or next(iter(brought), None)
    if chosen:
        return replace(scene, camera=chosen)
    return with_default_camera(scene)
