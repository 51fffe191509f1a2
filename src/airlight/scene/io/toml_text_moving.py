"""What moves in a scene, as keyframes in the tables of a scene file's text; twin of
`toml_animation`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..animation import Animation
from ..animation.density import VolumeTrack
from ..animation.file_sequence import FileSequence
from ..animation.rig import Rig
from ..animation.tracks import CameraTrack, Curves, EnvironmentTrack, LightTrack, MeshTrack
from ..scene import Scene
from . import VOLUME_SUFFIXES
from .grid_series import is_kind
from .toml_keys import KEYS
from .volume_scene import keys_of

_NOT_WRITTEN = "# How {what} moves cannot be said in a scene file: it is static.\n"
_USUAL = {"start_s": 0.0, "end_s": None, "fps": 24.0, "is_loop": False}
_MOVING = ("key", "between")


def with_motion(raw: dict[str, Any], scene: Scene, original: Scene, notes: list[str]) -> None:
    """Put the scene's animation into its tables.

    `raw` has the tables of `original`'s file, lights and camera as they are now. Meshes and
    volumes move as in that file, since they come from it; notes say what could not be written.
    """
    # What moves by the file itself, which the table names.
    tracks = scene.animation.tracks if scene.animation else ()
    kept = {_place(track) for track in (original.animation.tracks if original.animation else ())}
    # Keyframes of a camera are written again below, if it still moves.
    _drop(raw.get("camera") or {}, _MOVING)
    from_file = [t for t in tracks if isinstance(t, (MeshTrack, Rig, VolumeTrack))]
    if not any(_place(track) in kept for track in from_file):
        for table in raw.get("mesh", ()):
            _drop(table, _MOVING)
    # Keyframes into the table of what they move; the rest is said.
    for track in tracks:
        if isinstance(track, CameraTrack) and raw.get("camera"):
            _put(raw["camera"], track.curves, "camera", notes)
        elif isinstance(track, LightTrack) and track.index < len(raw["light"]):
            _put(raw["light"][track.index], track.curves, "light", notes)
        elif isinstance(track, EnvironmentTrack) and raw.get("environment"):
            _put(raw["environment"], track.curves, "environment", notes)
        elif _place(track) not in kept or not _is_in_file(track, raw):
            notes.append(_NOT_WRITTEN.format(what=_name(track)))
    raw["animation"] = _times(scene.animation, raw) if _moves(raw, from_file, kept) else {}


def name_grids(raw: Mapping[str, Any], original: Scene, source: str) -> None:
    """The table of a bare grid names what was chosen: its flames, its colours and its times.

    One that shows its file's times, or its files, one after the other is a sequence.
    """
    # Scene files say so themselves.
    if not is_kind(source, VOLUME_SUFFIXES):
        return
    for table, volume in zip(raw.get("volume", ()), original.volumes, strict=False):
        table |= keys_of(volume, Path(volume.source))
    for track in original.animation.tracks if original.animation else ():
        if not isinstance(track, VolumeTrack) or not isinstance(track.density, FileSequence):
            continue
        tables, of = raw.get("volume", ()), track.density
        if track.index < len(tables) and "file" in tables[track.index]:
            table = tables[track.index]
            table["sequence"] = table.pop("file")
            table |= {"sequence_fps": of.fps, "sequence_start_s": of.start_s}
    # One that was asked for so many a second, and is alone, is none.
    for table in raw.get("volume", ()):
        if "file" in table:
            table.pop("sequence_fps", None)


def _place(track: Any) -> tuple[type, int]:
    """What a track of a mesh or a volume moves."""
    first = getattr(track, "first", getattr(track, "first_mesh", -1))
    return type(track), getattr(track, "index", first)


def moves_light(scene: Scene) -> bool:
    """Whether keyframes move lights or the environment, which must then have tables."""
    tracks = scene.animation.tracks if scene.animation else ()
    return any(isinstance(track, (LightTrack, EnvironmentTrack)) for track in tracks)


def has_own_camera(scene: Scene) -> bool:
    """Whether a mesh file moves the camera: a [camera] beside it would hold it still."""
    tracks = scene.animation.tracks if scene.animation else ()
    return any(isinstance(track, Rig) and track.camera is not None for track in tracks)


def _put(table: dict[str, Any], curves: Curves, kind: str, notes: list[str]) -> None:
    """The curves as keyframes of a table, where it can say them."""
    _drop(table, _MOVING)
    first, *others = curves.values()
    known = _known(kind, table)
    # A table has one set of times and one interpolation for all of its keys.
    is_said = first.between in ("smooth", "linear", "step") and all(
        curve.between == first.between and np.array_equal(curve.times, first.times)
        for curve in others
    )
    if not is_said or not set(curves) <= known:
        notes.append(_NOT_WRITTEN.format(what=f"the {kind}"))
        return
    # "smooth" is what a table without the key means.
    if first.between != "smooth":
        table["between"] = first.between
    table["key"] = [
        {"time_s": float(time), **{name: _row(curve.values[k]) for name, curve in curves.items()}}
        for k, time in enumerate(first.times)
    ]


def _row(values: Any) -> Any:
    numbers = [float(v) for v in np.ravel(values)]
    return numbers[0] if len(numbers) == 1 else numbers


def _known(kind: str, table: Mapping[str, Any]) -> set[str]:
    """The names that keyframes of the table may set."""
    described = KEYS[kind]
    variants = described.variants or {}
    keys = (*described.keys, *variants.get(table.get("type", ""), ()))
    return {key.name for key in keys}


def _drop(table: dict[str, Any], names: Sequence[str]) -> None:
    for name in names:
        table.pop(name, None)


def _is_in_file(track: Any, raw: Mapping[str, Any]) -> bool:
    """Whether the tables that were copied from a file say how the track's things move."""
    if isinstance(track, VolumeTrack):
        volumes = raw.get("volume", ())
        return track.index < len(volumes) and "sequence" in volumes[track.index]
    return bool(raw.get("mesh"))


def _moves(raw: Mapping[str, Any], from_file: Sequence[Any], kept: set[Any]) -> bool:
    tables = [raw.get("camera") or {}, raw.get("environment") or {}, *raw.get("light", ())]
    copied = any(_place(track) in kept and _is_in_file(track, raw) for track in from_file)
    return copied or any("key" in table for table in tables)


def _times(animation: Animation | None, raw: Mapping[str, Any]) -> dict[str, Any]:
    """The [animation] table: what is not as usual, or was written before."""
    before = raw.get("animation", {})
    names = {"start_s": "start_s", "end_s": "end_s", "fps": "fps", "is_loop": "loop"}
    return {
        name: getattr(animation, field)
        for field, name in names.items()
        if getattr(animation, field) is not None
        and (getattr(animation, field) != _USUAL[field] or name in before)
    }


def _name(track: Any) -> str:
    kinds = {VolumeTrack: "a volume", MeshTrack: "a mesh", Rig: "a mesh"}
    return next((name for kind, name in kinds.items() if isinstance(track, kind)), "something")
