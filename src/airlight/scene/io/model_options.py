"""What may be asked for beside a file: how it lies, which of its grids or variants, parameters."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from ...errors import SceneError
from . import GLTF_SUFFIXES, MESH_SUFFIXES, USD_SUFFIXES, VOLUME_SUFFIXES
from .grid_series import kind_of
from .volumes import UPRIGHT_SUFFIXES

_BOTH = ("mesh files and density grids", (*MESH_SUFFIXES, *VOLUME_SUFFIXES))
_GRIDS = ("density grids", VOLUME_SUFFIXES)
_KINDS = {
    **dict.fromkeys(("up", "scale"), _BOTH),
    **dict.fromkeys(("grid", "channels", "sequence_fps"), _GRIDS),
    "variant": ("mesh files", MESH_SUFFIXES),
    "parameters": ("Mitsuba's files", (".xml",)),
}
"""Of which files an option is that is not of all."""


def model_keys(
    path: str, *, parameters: Mapping[str, Any] | None = None, **given: Any
) -> dict[str, Any]:
    """What is asked for beside the file, by the names of keys of [[mesh]] and [[volume]], checked;
    `parameters` among them.

    `given`: up, scale, variant, grid, channels and sequence_fps, as `load` has them. Raises
    SceneError where it is no file that has them.
    """
    from .toml_media_tables import VOLUME
    from .toml_tables import MESH

    # Parameters are Mitsuba's alone.
    if parameters and not _is_of(path, "parameters"):
        raise SceneError("parameters are for Mitsuba's files (.xml)", where=path)
    texts = {name: str(value) for name, value in (parameters or {}).items()}
    # An option left as it is by default says nothing, and is allowed for every file; grids differ.
    usual = {"up": None if _is_of(path, "grid") else "y", "scale": 1.0}
    asked = {name: value for name, value in given.items() if value not in (None, usual.get(name))}
    # Variants are of mesh files, names of grids; how a file lies and how large it is, of both.
    is_grid = kind_of(path) in VOLUME_SUFFIXES
    wrong = [name for name in asked if not _is_of(path, name)]
    if wrong:
        kinds, suffixes = _KINDS[wrong[0]]
        raise SceneError(
            f"{' and '.join(wrong)} {'is' if len(wrong) == 1 else 'are'} for {kinds} "
            f"({', '.join(suffixes)})",
            where=path,
            remedy="In a scene file, each [[mesh]] and each [[volume]] has keys of its own.",
        )
    # The checks of their keys hold here too, with their messages.
    keys = (VOLUME if is_grid else MESH).keys
    checked = {
        key.name: key.kind.check(asked[key.name], key.name) for key in keys if key.name in asked
    }
    return {**checked, "parameters": texts} if texts else checked


def fitting_options(path: str, options: Mapping[str, Any]) -> dict[str, Any]:
    """Those options of `load` that files of this kind have."""
    return {name: value for name, value in options.items() if _is_of(path, name)}


def left_open(path: str, told: Iterable[str] = ()) -> tuple[str, ...]:
    """Which of up and scale a file says nothing of; `told`: the warnings of its scene.

    There are none of what is no file, and of scene files, whose parts have keys of their own.
    """
    try:
        kind = kind_of(path)
    except SceneError:
        return ()
    if kind in UPRIGHT_SUFFIXES:
        # Coordinates have units; where no axis says that it is the height, that was told.
        return ("up",) if any("(--up " in text for text in told) else ()
    is_open = _is_of(path, "up") and kind not in (*GLTF_SUFFIXES, *USD_SUFFIXES)
    return ("up", "scale") if is_open else ()


def _is_of(path: str, name: str) -> bool:
    return name not in _KINDS or kind_of(path) in _KINDS[name][1]
