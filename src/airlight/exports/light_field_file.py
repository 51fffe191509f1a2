"""Light fields on disk: NumPy arrays, and a JSON header that says what and where they are.

An .npz holds the arrays and the header as text under `header`; a folder holds NAME.npy each and
header.json. Radiance is in real spherical harmonics of order 1, as other programs expect it.
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import OutputError, SceneError
from ..maths.transforms import triple
from ..scene.checks import path_text
from ..scene.io.files import inside, read_text
from ..scene.io.numpy_files import opened_npz, read_npy
from ..scene.io.writing import whole_file
from .light_field import LatticeLight, LightField, VolumeLight

FORMAT, VERSION = "airlight light field", 1
HEADER_FILE = "header.json"
_OF_PARSERS = (
    LookupError,
    ValueError,
    TypeError,
    AttributeError,
    RecursionError,
    ArithmeticError,
)
_Y0 = math.sqrt(1.0 / (4.0 * math.pi))
_Y1 = math.sqrt(3.0 / (4.0 * math.pi))
_TO_SH = np.array([1.0 / _Y0, 1.0 / _Y1, 1.0 / _Y1, 1.0 / _Y1])
_BAND_ORDER = [0, 2, 3, 1]  # (a, bx, by, bz) -> Y00, Y1-1 (y), Y10 (z), Y11 (x)

_ABOUT = {
    "axes": "arrays are (z, y, x, ...); right-handed, +Y up; metres; linear Rec.709",
    "axes_xyz": "per lattice: the unit vectors of the world along which its cells lie; its origin, "
    "its fade and the components of its SH and its six sides are along them",
    "origin_m": "per lattice: the low corner of cell (0, 0, 0), along axes_xyz; cell (i, j, k) has "
    "its middle at origin_m + cell_m (i + 1/2, j + 1/2, k + 1/2), where its values are",
    "fade_m": "per lattice, finest first: where its light begins, over which width, where it "
    "ends, over which width; beyond, the next lattice has it",
    "sh": {
        "order": 1,
        "basis": f"real, orthonormal: Y00 = {_Y0:.6f}, Y1-1 = {_Y1:.6f} y, Y10 = {_Y1:.6f} z, "
        f"Y11 = {_Y1:.6f} x",
        "direction": "the way the light travels; for the way it comes from, change the sign of "
        "the last three coefficients",
    },
}
_MEANINGS = {
    "surfaces": (
        "W m^-2 sr^-1",
        "(z, y, x, rgb, 4): SH of bounced and scattered radiance, for surfaces",
    ),
    "irradiance": ("W m^-2", "(z, y, x, 6, rgb): the same on surfaces that face +x -x +y -y +z -z"),
    "air": (
        "W m^-2 sr^-1",
        "(z, y, x, rgb, 4): SH of the radiance that air scatters; weigh l = 1 by g, times sigma_s",
    ),
    "openness": ("", "(z, y, x, 6): how open the faces at -x +x -y +y -z +z are"),
    "walls": ("cells", "(z, y, x, 3): how far walls lie from the cell's low faces"),
    "dead_ends": ("", "(z, y, x): bit k: the k-th of the ways +x -x +y -y +z -z leads into a wall"),
    "planes": (
        "cells",
        "(z, y, x, 4): the oblique plane that the cell is near, its unit normal times how far it "
        "counts (2 more on a thin board), and how far before it the cell's middle is",
    ),
}


def save_light_field(field: LightField, path: str | Path) -> None:
    """Write `path`: an .npz, or a folder (made where it is missing). Raises OutputError."""
    target = Path(path)
    arrays = _arrays(field)
    header = json.dumps(_header(field, arrays), indent=2)
    # One file with the header as text inside.
    if target.suffix == ".npz":
        with whole_file(target) as part:
            held: dict[str, Any] = {"header": np.array(header), **arrays}
            np.savez(part, **held)
        return
    # Or a file for each array; the header comes last, so that a folder that has one is whole.
    _make_folder(target)
    for name, array in arrays.items():
        with whole_file(target / f"{name}.npy") as part:
            np.save(part, array)
    with whole_file(target / HEADER_FILE) as part:
        part.write_text(header + "\n", encoding="utf-8")


def load_light_field(path: str | Path) -> LightField:
    """Read what `save_light_field` wrote. Raises SceneError."""
    source = Path(path_text(path, "a light field's file"))
    # Parsers raise errors of their own kinds; all of them are told as the file's.
    try:
        header, arrays = _read_folder(source) if source.is_dir() else _read_npz(source)
        if header["format"] != FORMAT or header["version"] != VERSION:
            raise SceneError(f"not an {FORMAT} of version {VERSION}", where=source)
        return _field(header, arrays)
    except SceneError as error:
        if error.where:
            raise
        raise SceneError(f"not a readable light field ({error.problem})", where=source) from None
    except _OF_PARSERS as error:
        raise SceneError(f"not a readable light field ({error})", where=source) from None


def _arrays(field: LightField) -> dict[str, NDArray[Any]]:
    # The names are the file's format: readers know them, so they outlive those in the code.
    made: dict[str, NDArray[Any]] = {}
    for index, cells in enumerate(field.lattices):
        name = f"lattice{index}_"
        made[f"{name}surfaces"] = _to_sh(cells.surfaces)
        made[f"{name}irradiance"] = cells.ambient_cubes()
        if cells.air is not None:
            made[f"{name}air"] = _to_sh(cells.air)
        made[f"{name}openness"], made[f"{name}walls"] = cells.openness, cells.walls
        if cells.dead_ends is not None:
            made[f"{name}dead_ends"] = cells.dead_ends
        if cells.planes is not None:
            made[f"{name}planes"] = cells.planes
    for index, volume in enumerate(field.volumes):
        made[f"volume{index}"] = volume.radiance
    return made


def _header(field: LightField, arrays: dict[str, Any]) -> dict[str, Any]:
    from .. import __version__

    # What made it.
    header: dict[str, Any] = {
        "format": FORMAT,
        "version": VERSION,
        "airlight": __version__,
        "scene": field.scene,
        "technique": field.technique,
        **_ABOUT,
    }
    # Where each lattice and each volume lies, and what its numbers are.
    header["lattices"] = [
        {
            "arrays": f"lattice{i}_...",
            "axes_xyz": cells.axes.tolist(),
            "origin_m": list(cells.origin),
            "cell_m": cells.cell,
            "count_xyz": list(cells.count),
            "fade_m": cells.fade.tolist(),
            "rule": cells.rule,
        }
        for i, cells in enumerate(field.lattices)
    ]
    header["volumes"] = [
        {
            "array": f"volume{i}",
            "world_from_unit": v.world_from_unit.tolist(),
            "eye_m": list(v.eye),
            "unit": "W m^-2 sr^-1",
            "meaning": "in-scattered radiance towards the eye, times sigma_s",
        }
        for i, v in enumerate(field.volumes)
    ]
    # All arrays by name.
    header["arrays"] = {
        name: {"shape": list(a.shape), "dtype": str(a.dtype), **_about(name)}
        for name, a in arrays.items()
    }
    return header


def _about(name: str) -> dict[str, str]:
    # A lattice's arrays by the name behind their number; all others are volumes.
    unit, meaning = _MEANINGS.get(
        name.partition("_")[2], ("W m^-2 sr^-1", "(z, y, x, rgb): see volumes")
    )
    return {"unit": unit, "meaning": meaning}


def _to_sh(bands: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.asarray((bands * _TO_SH)[..., _BAND_ORDER], np.float32)


def _from_sh(sh: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.asarray(sh[..., np.argsort(_BAND_ORDER)] / _TO_SH, np.float32)


def _make_folder(target: Path) -> None:
    try:
        target.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(
            f"cannot be made a folder ({error.strerror or error})",
            where=target,
            remedy="Choose another place, or end its name in .npz.",
        ) from None


def _read_folder(folder: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    # Names come from the header, and lead nowhere outside of the folder.
    header = json.loads(read_text(folder / HEADER_FILE))
    files = {name: inside(folder, f"{name}.npy", folder) for name in header["arrays"]}
    return header, {name: read_npy(file) for name, file in files.items()}


def _read_npz(path: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    with opened_npz(path) as archive:
        header = json.loads(str(archive.array("header", kinds="U")))
        return header, {name: archive.array(name) for name in header["arrays"]}


def _field(header: dict[str, Any], arrays: dict[str, Any]) -> LightField:
    lattices = tuple(
        _lattice(about, f"lattice{i}_", arrays) for i, about in enumerate(header["lattices"])
    )
    volumes = tuple(
        VolumeLight(arrays[v["array"]], np.array(v["world_from_unit"]), triple(v["eye_m"]))
        for v in header["volumes"]
    )
    return LightField(header["technique"], header["scene"], lattices, volumes)


def _lattice(about: dict[str, Any], name: str, arrays: dict[str, Any]) -> LatticeLight:
    # Files of earlier versions have no axes: cells lay along the world's.
    air = arrays.get(f"{name}air")
    return LatticeLight(
        axes=np.array(about.get("axes_xyz", np.eye(3)), np.float64),
        origin=triple(about["origin_m"]),
        cell=about["cell_m"],
        rule=about["rule"],
        fade=np.array(about["fade_m"]),
        surfaces=_from_sh(arrays[f"{name}surfaces"]),
        openness=arrays[f"{name}openness"],
        walls=arrays[f"{name}walls"],
        air=None if air is None else _from_sh(air),
        dead_ends=arrays.get(f"{name}dead_ends"),
        planes=arrays.get(f"{name}planes"),
    )
