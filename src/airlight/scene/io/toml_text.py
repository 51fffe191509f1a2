"""A scene as the text of a scene file: what was loaded, with what was changed since.

Meshes, grids and maps stay the files that they came from; tables and keys that cannot have
changed are copied as they were. The twin of `toml`.
"""

from __future__ import annotations

import os
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera
from ..environment import Environment
from ..lights import Light
from ..medium import Medium
from ..scene import Scene
from ..studio import NAME as STUDIO
from ..sun_sky import followed
from ..volume import Volume
from . import MESH_SUFFIXES, VOLUME_SUFFIXES
from .coefficient_files import NAMES as COEFFICIENTS
from .coefficient_files import OF_DENSITY
from .files import read_text
from .grid_series import is_kind, only_file
from .ground import ground_tables
from .light_groups import is_group
from .toml_sky import sky_table
from .toml_syntax import toml_lines
from .toml_text_moving import has_own_camera, moves_light, name_grids, with_motion

_NO_MESHES = "# The meshes of {source} are no file that a [[mesh]] can name: add your own.\n"
_NO_MAP = "# The environment's image is no file: its mean stands for it.\n"
_NO_GRID = "# A volume's density is no file: it is left out.\n"
_NO_ALBEDO = "# A changed albedo is left out where grids say sigma_s and sigma_a.\n"
_SCATTERING = ("sigma_s", "sigma_a", "sigma_t", "albedo", "g", "emission")


def scene_text(
    scene: Scene,
    original: Scene,
    source: str,
    folder: Path,
    settings: Mapping[str, Mapping[str, Any]] | None = None,
    model: Mapping[str, Any] | None = None,
) -> str:
    """A scene file for `scene`, loaded from `source` as `original` and changed since.

    `source` is a file, or builtin:NAME. The text's paths are relative to `folder`, where it will
    stand. `settings` by technique are written over the scene's own; `model` are the keys with
    which a model or grid was loaded (up, scale, grid). A comment says what could not be written.
    """
    scene = followed(scene)
    raw, notes = _original(source, folder, model or {})
    name_grids(raw, original, source)
    raw["sky"] = sky_table(scene, original, raw.get("sky", {}))
    if raw["sky"]:
        raw.pop("environment", None)
        # The sun is the sky's, not a [[light]].
        scene = replace(scene, lights=scene.lights[:-1], environment=None)
        had_sky = original.environment is not None and original.environment.sky is not None
        lights = original.lights[:-1] if had_sky else original.lights
        original = replace(original, lights=lights, environment=None)
    # The camera, unless it is the one that framing chooses again.
    raw["camera"] = {**raw.get("camera", {}), **_camera(scene.camera)}
    if has_own_camera(scene):
        raw["camera"] = {}
    # Lights and environment, unless they are the defaults of a scene without any.
    is_default = _is_default_light(raw, scene, original)
    notes_before = len(notes)
    own_lights = scene.lights[: len(scene.lights) - _brought(raw, original)]
    groups = [table for table in raw.get("light", []) if is_group(table)]
    raw["light"] = [*(_light(light) for light in own_lights), *groups]
    written = _environment_file(raw.get("environment", {}), scene, original, folder)
    raw["environment"] = _environment(written, scene.environment, notes)
    if is_default:
        raw["light"], raw["environment"] = groups, {}
        del notes[notes_before:]
    # A ground that was put under the model when it was loaded becomes a mesh of the file.
    if (model or {}).get("ground", False) is not False:
        raw["mesh"] = [*raw.get("mesh", ()), *ground_tables(scene)]
    # Media, and what moves.
    raw["medium"] = _medium(scene.medium, raw.get("medium", {}))
    raw["volume"] = _volumes(scene.volumes, raw.get("volume", []), notes, folder)
    with_motion(raw, scene, original, notes)
    # Settings by technique; then all tables in the order of the reference page.
    techniques = dict(scene.settings)
    chosen = settings or {}
    techniques |= {name: {**techniques.get(name, {}), **chosen[name]} for name in chosen}
    raw["technique"] = {name: dict(values) for name, values in techniques.items() if values}
    order = ("camera", "mesh", "light", "environment", "sky", "medium", "volume")
    ordered = {name: raw[name] for name in (*order, *raw) if raw.get(name)}
    return "".join(notes) + "\n".join(toml_lines(ordered)).strip() + "\n"


_NO_KEYS = ("sun", "ground", "parameters")  # what is asked for beside the keys of its table


def _original(
    source: str, folder: Path, model: Mapping[str, Any]
) -> tuple[dict[str, Any], list[str]]:
    path = only_file(source)
    if path.suffix.lower() == ".toml":
        raw = tomllib.loads(read_text(path))
        many = (table for name in ("mesh", "volume", "light") for table in raw.get(name, []))
        for table in (*many, raw.get("environment", {})):
            for key in ("file", "sequence", "shape"):
                written = table.get(key, STUDIO)
                if written != STUDIO and (key != "shape" or Path(written).suffix):
                    table[key] = _relative(path.parent / written, folder)
        return raw, []
    # Of another file, a table that names it.
    placed = {name: model[name] for name in model if name not in _NO_KEYS}
    for name, suffixes in (("mesh", MESH_SUFFIXES), ("volume", VOLUME_SUFFIXES)):
        if is_kind(path, suffixes):
            return {name: [{"file": _relative(path, folder), **placed}]}, []
    return {}, [_NO_MESHES.format(source=source)]


def _relative(path: Path, folder: Path) -> str:
    try:
        return Path(os.path.relpath(path, folder)).as_posix()
    except ValueError:  # another drive
        return path.resolve().as_posix()


def _brought(raw: Mapping[str, Any], original: Scene) -> int:
    """How many lights, the last ones, come with the mesh files and are placed by them."""
    if "environment" not in raw and original.environment is not None:
        return 0  # nothing shone: a loader added sun and sky
    own = [table for table in raw.get("light", ()) if not is_group(table)]
    return max(0, len(original.lights) - len(own))


def _is_default_light(raw: Mapping[str, Any], scene: Scene, original: Scene) -> bool:
    """Whether nothing shines of itself, and the loader's sun and sky are as it made them.

    Not beside surfaces that emit: a scene file's loader adds nothing to them.
    """
    if any(mesh.material.is_emissive for mesh in original.meshes):
        return False
    now, before = scene.environment, original.environment
    if any(name in raw for name in ("light", "environment")) or moves_light(scene):
        return False
    if now is None or before is None or now.map is None or before.map is None:
        return False
    if now.source == STUDIO:
        return False  # it has a name
    # As the loader made them: the same values, the same lights, the same pixels.
    plain = ("radiance", "scale", "rotation_deg", "visible")
    is_same_sky = all(getattr(now, key) == getattr(before, key) for key in plain)
    is_same_light = is_same_sky and scene.lights == original.lights
    return is_same_light and np.array_equal(now.map, before.map)


def _camera(camera: Camera) -> dict[str, Any]:
    table = {"position": camera.position, "target": camera.target, "fov_y_deg": camera.fov_y_deg}
    if camera.up != (0.0, 1.0, 0.0):
        table["up"] = camera.up
    # What differs from a new camera.
    usual = Camera()
    for name in ("aperture_m", "focus_m", "shutter_s", "film_px"):
        if getattr(camera, name) != getattr(usual, name):
            table[name] = getattr(camera, name)
    table["exposure_stops"] = "auto" if camera.exposure_stops is None else camera.exposure_stops
    return table


def _light(light: Light) -> dict[str, Any]:
    """What it must say, then what is not as usual."""
    required = {key.name: getattr(light, key.name) for key in light.keys if key.required}
    usual = type(light)(**required)
    table: dict[str, Any] = {"type": light.type_name}
    for key in light.keys:
        value = getattr(light, key.name)
        if key.required or value != getattr(usual, key.name):
            table[key.name] = _colour(value) if key.stands_for == "strength" else value
    return table


def _environment_file(
    raw: Mapping[str, Any], scene: Scene, original: Scene, folder: Path
) -> Mapping[str, Any]:
    """[environment] as it was, its file that of the scene's map; none where that has no file."""
    now, before = scene.environment, original.environment
    if now is not None and now.source == STUDIO:
        return {**raw, "file": STUDIO}
    # The file's map stays named while the environment comes from the same source.
    if now is not None and before is not None and now.source == before.source:
        return raw
    other = {key: value for key, value in raw.items() if key != "file"}
    has_file = now is not None and now.map is not None and Path(now.source).is_file()
    return {**other, "file": _relative(Path(now.source), folder)} if now and has_file else other


def _environment(
    raw: Mapping[str, Any], environment: Environment | None, notes: list[str]
) -> dict[str, Any]:
    if environment is None:
        return {}
    # A map that no file holds is written as its mean.
    table = {key: raw[key] for key in ("file",) if key in raw}
    if not table and environment.map is not None:
        notes.append(_NO_MAP)
        mean = np.asarray(environment.map, np.float64).reshape(-1, 3).mean(axis=0)
        table["radiance"] = _colour(tuple(mean.tolist()))
    elif not table:
        table["radiance"] = _colour(environment.radiance)
    # What differs from a new environment, or was said before.
    changed = {"scale": 1.0, "rotation_deg": 0.0, "visible": True}
    return table | {
        key: getattr(environment, key)
        for key, usual in changed.items()
        if getattr(environment, key) != usual or key in raw
    }


def _medium(medium: Medium | None, raw: Mapping[str, Any]) -> dict[str, Any]:
    if medium is None:
        return {}
    extent = ("bounds", "endless", "top")
    # Keys that coefficients replace are dropped, whichever of their spellings was used.
    kept = {key: value for key, value in raw.items() if key not in (*_SCATTERING, *extent)}
    given = {key: getattr(medium, key) for key in extent}
    said = {key: value for key, value in given.items() if value is not None and value is not False}
    return {**kept, **_scattering(medium), **said}


def _scattering(of: Medium | Volume) -> dict[str, Any]:
    own = of.emission if isinstance(of, Medium) else of.emission and of.emission.radiance
    emitted = {"emission": _colour(own)} if own and max(own) > 0.0 else {}
    return {
        "sigma_t": _colour(of.sigma_t),
        "albedo": _colour(of.albedo),
        "g": _colour(of.g),
        **emitted,
    }


def _volumes(
    volumes: Sequence[Volume], raw: Sequence[Mapping[str, Any]], notes: list[str], folder: Path
) -> list[dict[str, Any]]:
    tables = []
    # Volumes of the file stand in its order: each keeps its table, with new coefficients.
    for volume, table in zip(volumes, raw, strict=False):
        kept = {key: value for key, value in table.items() if key not in _SCATTERING}
        tables.append({**kept, **_by_voxel(_scattering(volume), table, notes)})
    # Volumes that were added have no file; a shape needs none.
    for volume in volumes[len(raw) :]:
        is_moved = not np.array_equal(volume.world_from_volume, np.eye(4))
        placed: dict[str, Any] = {"matrix": volume.world_from_volume.ravel()} if is_moved else {}
        if volume.density is None:
            placed |= {"shape": volume.shape, "bounds": volume.bounds}
        elif volume.body is not None and volume.source:
            placed["shape"] = _relative(Path(volume.source), folder)
        else:
            notes.append(_NO_GRID)
            continue
        tables.append({**placed, **_scattering(volume)})
    return tables


def _by_voxel(
    coefficients: dict[str, Any], table: Mapping[str, Any], notes: list[str]
) -> dict[str, Any]:
    """The coefficients of a volume as the factors of the grids that its table names."""
    grids = [name for name in COEFFICIENTS if f"{name}_grid" in table]
    if "g" in grids:
        coefficients.pop("g")
    if not any(name in grids for name in OF_DENSITY):
        return coefficients
    # Its extinction is one with such grids: what it is now is a factor of what the file said.
    scale = np.array(coefficients.pop("sigma_t"), np.float64)
    albedo = np.array(coefficients.pop("albedo"), np.float64)
    for name in OF_DENSITY:
        if name in table or name in grids:
            coefficients[name] = _factor(table.get(name, 1.0), scale)
    # An albedo without a grid is itself; with one it is a factor of what the file said.
    if "sigma_t" in coefficients:
        said = table.get("albedo", 1.0) if "albedo" in grids else 1.0
        coefficients["albedo"] = _factor(said, albedo)
    elif np.any(albedo != 1.0):
        notes.append(_NO_ALBEDO)
    return coefficients


def _factor(number: Any, factor: NDArray[np.float64]) -> Any:
    """A coefficient times what it is to be multiplied with."""
    return _colour(np.broadcast_to(np.multiply(number, factor), 3).tolist())


def _colour(rgb: Sequence[float]) -> Any:
    """One number for a grey."""
    return rgb[0] if len(set(rgb)) == 1 else rgb
