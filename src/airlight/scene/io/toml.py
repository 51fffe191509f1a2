"""Read a scene file, version 1 (TOML).

`toml_tables` says what may stand in one; docs/scene-file.md is printed from it.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from ...errors import SceneError, nearest
from ..camera import Camera
from ..checks import Rgb
from ..environment import Environment
from ..lights import DirectionalLight, Light, PointLight, SpotLight
from ..medium import Medium, extinction_and_albedo
from ..scene import Scene
from ..volume import Volume
from .files import read_bytes
from .toml_meshes import existing_file, placed_mesh
from .toml_schema import check_table
from .toml_tables import CAMERA, ENVIRONMENT, LIGHT, MEDIUM, MESH, TABLES, VOLUME

Raw = Mapping[str, Any]

_LIGHT_CLASSES: dict[str, Callable[..., Light]] = {
    "directional": DirectionalLight,
    "point": PointLight,
    "spot": SpotLight,
}


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
    try:
        return tomllib.loads(read_bytes(path).decode("utf-8"))
    except UnicodeDecodeError as error:
        raise SceneError(f"is not UTF-8 text (byte {error.start})", where=path) from None
    except RecursionError:
        raise SceneError("is nested too deeply", where=path) from None
    except tomllib.TOMLDecodeError as error:
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
    for name, value in raw.items():
        if name not in known:
            kind = "table" if isinstance(value, (dict, list)) else "key outside any table,"
            raise SceneError(f"unknown {kind} '{name}'", remedy=nearest(name, known))
        table = headers.get(name)
        if table is not None and table.repeated != isinstance(value, list):
            raise SceneError(f"'{name}' must be written as a {table.header} table")


def _scene(raw: Raw, path: Path) -> Scene:
    folder, camera = path.parent, _camera(raw)
    parts = [
        placed_mesh(check_table(MESH, table, label), label, folder)
        for label, table in _numbered(raw, "mesh")
    ]
    volumes = [_volume(table, label, folder) for label, table in _numbered(raw, "volume")]
    lights = [_light(table, label) for label, table in _numbered(raw, "light")]
    said: list[str] = []
    scene = Scene(
        meshes=tuple(mesh for part in parts for mesh in part.meshes),
        lights=(*lights, *(light for part in parts for light in part.lights)),
        environment=_environment(raw, folder, said),
        medium=_medium(raw),
        volumes=tuple(volume for volume, _ in volumes),
        settings=_technique_settings(raw),
        name=path.stem,
        warnings=(
            *(warning for part in parts for warning in part.warnings),
            *(warning for _, warnings in volumes for warning in warnings),
            *said,
        ),
    )
    if not (scene.meshes or scene.volumes or scene.medium):
        raise SceneError("there is nothing to see: no [[mesh]], [[volume]] or [medium]")
    return _with_light(_with_camera(scene, camera, parts))


def _numbered(raw: Raw, name: str) -> Iterator[tuple[str, Any]]:
    """(key path, table) of every [[name]], counted from 1."""
    for number, table in enumerate(raw.get(name, ()), start=1):
        yield f"[[{name}]] {number}", table


@contextmanager
def _inside(label: str) -> Iterator[None]:
    """Put the key path before what a scene value says of itself."""
    try:
        yield
    except SceneError as error:
        if error.where or error.problem.startswith(label):
            raise
        raise SceneError(f"{label}: {error.problem}", remedy=error.remedy) from None


def _camera(raw: Raw) -> Camera | None:
    if "camera" not in raw:
        return None
    values = check_table(CAMERA, raw["camera"], CAMERA.header)
    with _inside(CAMERA.header):
        return Camera(**values)


def _light(raw: Any, label: str) -> Light:
    values = check_table(LIGHT, raw, label)
    with _inside(label):
        return _LIGHT_CLASSES[values.pop("type")](**values)


def _environment(raw: Raw, folder: Path, said: list[str]) -> Environment | None:
    """[environment], or None; what its file left to doubt is added to `said`."""
    label = ENVIRONMENT.header
    if "environment" not in raw:
        return None
    values = check_table(ENVIRONMENT, raw["environment"], label)
    if "file" in values and "radiance" in values:
        raise SceneError(f"{label} has both a file and a radiance", remedy="Use one of them.")
    with _inside(label):
        if "file" in values:
            from .images import read_radiance

            written = values.pop("file")
            values["map"] = read_radiance(existing_file(folder / written, written, label), said)
            values["source"] = written
        return Environment(**values)


def _medium(raw: Raw) -> Medium | None:
    label = MEDIUM.header
    if "medium" not in raw:
        return None
    values = check_table(MEDIUM, raw["medium"], label)
    with _inside(label):
        return Medium(**_with_extinction(values, label))


def _with_extinction(values: dict[str, Any], label: str) -> dict[str, Any]:
    """The values with sigma_s and sigma_a turned into sigma_t and albedo."""
    scattering = [name for name in ("sigma_s", "sigma_a") if name in values]
    extinction = [name for name in ("sigma_t", "albedo") if name in values]
    remedy = "Use sigma_t and albedo, or sigma_s and sigma_a."
    if scattering and extinction:
        raise SceneError(f"{label} mixes {scattering[0]} with {extinction[0]}", remedy=remedy)
    if not scattering and "sigma_t" not in values:
        raise SceneError(f"{label} has no sigma_t", remedy=remedy)
    if not scattering:
        return values
    nothing: Rgb = (0.0, 0.0, 0.0)
    pair = (values.pop("sigma_s", nothing), values.pop("sigma_a", nothing))
    sigma_t, albedo = extinction_and_albedo(*pair)
    return {**values, "sigma_t": sigma_t, "albedo": albedo}


def _volume(raw: Any, label: str, folder: Path) -> tuple[Volume, tuple[str, ...]]:
    """The volume, and what its file left open."""
    values = _with_extinction(check_table(VOLUME, raw, label), label)
    if ("file" in values) == ("shape" in values):
        raise SceneError(f"{label} needs either a file or a shape")
    if "shape" in values:
        for name in ("grid", "channels"):
            if name in values:
                raise SceneError(f"{label}: {name} belongs to a file, not to a shape")
        with _inside(label):
            return Volume(**values), ()
    from .volumes import read_volume

    written = values.pop("file")
    file = existing_file(folder / written, written, label)
    grid = read_volume(file, values.pop("grid", "density"), values.pop("channels", "density"))
    warnings = grid.warnings if "bounds" not in values else ()
    with _inside(label):
        values = {"bounds": grid.bounds, **values}
        return Volume(density=grid.density, source=written, **values), warnings


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
    brought = [part.camera for part in parts if part.camera != Camera()]
    chosen = camera or next(iter(brought), None)
    if chosen:
        return replace(scene, camera=chosen)
    from .defaults import with_default_camera

    return with_default_camera(scene)


def _with_light(scene: Scene) -> Scene:
    """The scene; with a default sun and sky where nothing in it shines."""
    if scene.lights or scene.environment or any(m.material.is_emissive for m in scene.meshes):
        return scene
    from .defaults import with_default_lights

    return with_default_lights(scene)
