"""The keyframes and sequences of a scene file as tracks."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import SceneError, nearest
from ..animation import Animation, Curve, Track
from ..animation.file_sequence import FileSequence
from ..animation.rig import Rig
from ..animation.tracks import MeshTrack, Placing
from ..checks import F64
from ..scene import Scene
from .files import check_named, named_file
from .grid_series import matching
from .grid_times import Times
from .toml_keys import ANIMATION, KEYS
from .toml_schema import Table, check_table
from .volumes import NOWHERE, VolumeGrid, is_grid_file

Raw = Mapping[str, Any]
_PLACES = ("translate", "rotate_deg", "scale")


def take_keys(raw: Any, label: str) -> tuple[Any, list[Any]]:
    """A table without its keyframes, and those. Raises SceneError where they are no list."""
    if not isinstance(raw, dict) or "key" not in raw:
        return raw, []
    keys = raw["key"]
    if not isinstance(keys, list) or not keys:
        raise SceneError(f"{label}: key must be written as [[{_plain(label)}.key]] tables")
    return {name: value for name, value in raw.items() if name != "key"}, keys


def with_curves(table: Table, raw: Any, label: str) -> tuple[dict[str, Any], dict[str, Curve]]:
    """The checked values of a table, and the curves of its keyframes by name.

    Raises SceneError, also for keyframes that do not rise in time, or differ in what they set.
    """
    still, keys = take_keys(raw, label)
    values = check_table(table, still, label)
    between = values.pop("between", "smooth")
    # Keyframes of a light have the keys of its type.
    of = KEYS[table.name]
    if of.variants is not None:
        of = Table(of.name, of.doc, of.keys + of.variants[values[of.variant_key]], repeated=True)
    return values, _curves(of, keys, between, label) if keys else {}


def _curves(table: Table, keys: Sequence[Any], between: str, label: str) -> dict[str, Curve]:
    # Each keyframe is checked as a table of its own.
    rows = [
        check_table(table, key, f"{label} key {number}") for number, key in enumerate(keys, start=1)
    ]
    names = [name for name in rows[0] if name != "time_s"]
    if not names:
        raise SceneError(f"{label} key 1 changes nothing: it sets time_s alone")
    # Each keyframe sets the same keys, so that every key is a curve over all times.
    for number, row in enumerate(rows, start=1):
        odd = set(row) ^ set(rows[0])
        if odd:
            raise SceneError(
                f"{label}: key {number} and key 1 differ in whether they set {sorted(odd)[0]}",
                remedy="All keyframes of a table set the same keys.",
            )
    # One curve for each key; colours and vectors have several components.
    times = np.array([row["time_s"] for row in rows])
    try:
        return {
            name: Curve(
                times, np.array([row[name] for row in rows]).reshape(len(rows), -1), between
            )
            for name in names
        }
    except SceneError as error:
        raise SceneError(f"{label}: {error.problem}") from None


def mesh_tracks(
    part: Scene, values: Raw, keys: Sequence[Any], placed: F64, upright: F64, label: str
) -> tuple[Track, ...]:
    """What moves the meshes of one [[mesh]]: its file's animation, its keyframes, or both.

    `part` is the file's scene before it is placed, `values` the table's; `placed` (4, 4) places it
    in the world without keyframes, `upright` (4, 4) turns the file's upwards axis to +Y.
    """
    rigs = [t for t in (part.animation.tracks if part.animation else ()) if isinstance(t, Rig)]
    placing: Any = placed
    # Keyframes move the table's placement, so they cannot stand beside a matrix.
    if keys:
        if "matrix" in values:
            raise SceneError(
                f"{label} has keyframes beside matrix",
                remedy="Use translate, rotate_deg and scale.",
            )
        still = {name: values[name] for name in _PLACES if name in values}
        placing = Placing(
            _curves(KEYS["mesh"], keys, values.get("between", "smooth"), label), still, upright
        )
    # The file's own animation goes on within that placement.
    if rigs:
        return tuple(replace(_clip(rig, values, label), world_from_file=placing) for rig in rigs)
    for name in ("clip", "clip_start_s", "clip_speed", "clip_loop"):
        if name in values:
            raise SceneError(f"{label}: {name} is set, but its file is not animated")
    if not keys:
        return ()
    return (MeshTrack(0, np.array([m.world_from_object for m in part.meshes]), placing),)


def _clip(rig: Rig, values: Raw, label: str) -> Rig:
    names = [clip.name for clip in rig.clips]
    wanted = values.get("clip", names[0])
    if wanted not in names:
        raise SceneError(f"{label}: the file has no clip '{wanted}'", remedy=nearest(wanted, names))
    return replace(
        rig,
        clip=names.index(wanted),
        start_s=values.get("clip_start_s", 0.0),
        speed=values.get("clip_speed", 1.0),
        is_loop=values.get("clip_loop", False),
    )


def shifted(track: Track, meshes: int, lights: int, *, has_camera: bool) -> Track:
    """A part's track when `meshes` and `lights` of others come before the part's.

    `has_camera`: the scene file has a camera, and does not look through the part's.
    """
    if isinstance(track, Rig):
        camera = None if has_camera else track.camera
        return replace(track, first_mesh=meshes, first_light=lights, camera=camera)
    return replace(track, first=meshes) if isinstance(track, MeshTrack) else track


def volume_files(pattern: str, folder: Path, label: str) -> tuple[Path, ...]:
    """The files of a sequence, sorted by the numbers in their names. Raises SceneError."""
    path = named_file(pattern, "", folder)
    # A folder stands for all files in it, unless it is a grid's own; * may stand in the name alone.
    try:
        is_folder = path.is_dir() and not is_grid_file(path)
        base, name = (path, "*") if is_folder else (path.parent, path.name)
        if "**" in name:
            raise SceneError(f"{label}: sequence '{pattern}' must name files of one folder")
        found = matching(base, name)
    except (OSError, ValueError):  # a name that no file system takes
        found = []
    if not found:
        raise SceneError(
            f"{label}: sequence '{pattern}' names no files",
            remedy="Paths are relative to the scene file; * stands for any number.",
        )
    for file in found:  # which may be links
        check_named(file, pattern, "", folder)
    return tuple(file.resolve() for file in found)


def file_sequence(
    values: dict[str, Any],
    files: tuple[Path, ...],
    times: Times,
    grid: VolumeGrid,
    emission_grid: str | None,
    colours: Mapping[str, str],
) -> FileSequence:
    """The sequence that a [[volume]]'s keys describe; takes them out of `values`.

    `times` as `FileSequence` has them.
    `grid`: of the file that says where it lies. Where the table has `bounds`, or files do not say
    where they are, all files have its box. `colours`: names of grids, by coefficient.
    """
    names = {
        "sequence_fps": "fps",
        "sequence_start_s": "start_s",
        "sequence_loop": "is_loop",
        "between": "between",
        "grid": "grid",
        "channels": "channels",
    }
    given = {field: values.pop(name) for name, field in names.items() if name in values}
    has_own_box = "bounds" not in values and not any(NOWHERE in text for text in grid.warnings)
    return FileSequence(
        files,
        grid.density.shape,
        **given,
        emission_grid=emission_grid,
        colours=tuple(colours.items()),
        bounds=grid.bounds if has_own_box else None,
        turn=grid.world_from_volume,
        times=times,
    )


def animation(raw: Raw, tracks: Sequence[Track]) -> Animation | None:
    """The scene's animation; None where nothing moves. Raises SceneError."""
    values = check_table(ANIMATION, raw.get("animation", {}), ANIMATION.header)
    # Times of a sequence in which nothing moves are a mistake.
    if not tracks:
        if "animation" in raw:
            raise SceneError(
                f"there is an {ANIMATION.header}, but nothing moves",
                remedy="Add [[camera.key]], [[light.key]], [[mesh.key]], [[environment.key]] or a "
                "volume sequence.",
            )
        return None
    return Animation(tuple(tracks), is_loop=values.pop("loop", False), **values)


def _plain(label: str) -> str:
    found = re.match(r"\[+(\w+)", label)
    return found[1] if found else label
