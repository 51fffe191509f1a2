"""[medium] and [[volume]] of a scene file: their keys, part of `toml_tables`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from ...errors import SceneError, nearest
from .. import checks
from ..keys import BOOLEAN, BOUNDS, COLOUR, NUMBER, PATH, REFLECTANCE, TEXT, Key, Kind
from .toml_keys import SEQUENCE_KEYS
from .toml_schema import MEAN_COSINE, PLACEMENT, UP, Table

_SCATTERING = (
    Key("sigma_t", COLOUR, "extinction coefficient", "m^-1"),
    Key("albedo", REFLECTANCE, "sigma_s / sigma_t; only with sigma_t", default="1"),
    Key("sigma_s", COLOUR, "scattering coefficient, instead of sigma_t and albedo", "m^-1"),
    Key("sigma_a", COLOUR, "absorption coefficient, beside sigma_s", "m^-1", "0"),
    Key(
        "g",
        MEAN_COSINE,
        "mean cosine of Henyey-Greenstein scattering, in (-1, 1); above 0 forwards",
        default="0",
    ),
)

_EMISSION = Key(
    "emission",
    COLOUR,
    "light that it gives off itself, at density 1 and in proportion to it",
    "W m^-3 sr^-1",
    "0",
)

_COEFFICIENT_GRIDS = tuple(
    Key(
        f"{name}_grid",
        TEXT,
        f"which of the file's named grids {meaning}; of one channel or of three",
    )
    for name, meaning in (
        ("sigma_t", "extinction is in proportion to, not the density; sigma_t is then 1"),
        ("albedo", "`albedo` is multiplied with, voxel by voxel: `Cd`"),
        ("sigma_s", "scattering is in proportion to, not the density; sigma_s is then 1"),
        ("sigma_a", "absorption is in proportion to, not the density; sigma_a is then 1"),
        ("g", "holds the mean cosine, instead of `g`"),
    )
)

_EMISSION_GRIDS = (
    Key(
        "emission_grid",
        TEXT,
        "which of the file's named grids the emission is in proportion to, instead of the density: "
        "`flame`, `heat`; then `emission` is 1 by default",
    ),
    Key(
        "temperature_grid",
        TEXT,
        "which of them holds temperatures: the emission is that of black bodies, times `emission`, "
        "which is then in m^-1 and 1 by default",
    ),
    Key(
        "temperature_scale",
        NUMBER,
        "kelvin are (value - temperature_offset) * temperature_scale",
        default="1",
    ),
    Key("temperature_offset", NUMBER, "see temperature_scale", default="0"),
)

SHAPES = ("box", "sphere")


def _shape(value: Any, name: str) -> str:
    """A shape's name, or the path of a mesh file. Raises SceneError."""
    from . import MESH_SUFFIXES, VOLUME_SUFFIXES

    written = checks.text(value, name)
    suffix = Path(written).suffix.lower()
    if written in SHAPES or suffix in MESH_SUFFIXES:
        return written
    if suffix in VOLUME_SUFFIXES:
        raise SceneError(f"{name}: '{written}' is a density grid", remedy="Name it as the file.")
    if suffix:
        known = f"Known endings: {', '.join(MESH_SUFFIXES)}."
        raise SceneError(f"{name}: '{written}' is no mesh file", remedy=known)
    raise SceneError(
        f"{name} must be 'box', 'sphere' or the path of a mesh file, not '{written}'",
        remedy=nearest(written, SHAPES),
    )


_SHAPE = Kind('"box", "sphere" or a path', _shape)

MEDIUM = Table(
    "medium",
    "A homogeneous medium. Without bounds it fills the scene's bounds, the camera included.",
    (
        *_SCATTERING,
        _EMISSION,
        Key("bounds", BOUNDS, "the box it fills", "m"),
        Key(
            "endless", BOOLEAN, "it goes on sideways and downwards without an end", default="false"
        ),
        Key(
            "top",
            NUMBER,
            "height above which there is none; only of an endless medium, by default the "
            "scene's and a quarter more",
            "m",
        ),
    ),
)

VOLUME = Table(
    "volume",
    "A medium of varying density: a density grid, or a shape of density 1. Coefficients hold at "
    "density 1. It is placed as a mesh is, after its bounds, and coefficients are per metre of the "
    "world: a grid that `scale` makes twice as long is twice as deep. A scene may have 256 media, "
    "its [medium] included; they may overlap.",
    (
        Key(
            "file",
            PATH,
            "a density grid: NumPy .npy or .npz, Mitsuba .vol, NanoVDB .nvdb, OpenVDB .vdb, VTK "
            ".vti, NetCDF .nc, .zarr",
        ),
        Key(
            "shape",
            _SHAPE,
            "instead of a file: fills its bounds with density 1; of a mesh file, which has no "
            "bounds, what its meshes enclose together",
        ),
        Key("grid", TEXT, "which of a file's named grids", default='"density"'),
        Key(
            "channels",
            TEXT,
            'which channel holds the density: "density" (the only one), "r", "g", "b" or "a"',
            default='"density"',
        ),
        Key("bounds", BOUNDS, "the world box that the grid or shape fills", "m", "the file's own"),
        *SEQUENCE_KEYS,
        replace(UP, doc=f"{UP.doc}; NetCDF and zarr files say so themselves"),
        *PLACEMENT,
        *_SCATTERING,
        _EMISSION,
        *_EMISSION_GRIDS,
        *_COEFFICIENT_GRIDS,
        Key(
            "detail",
            NUMBER,
            "finer noise than the grid's where it is drawn; about its deviation at density 1",
            default="0",
        ),
    ),
    repeated=True,
)
