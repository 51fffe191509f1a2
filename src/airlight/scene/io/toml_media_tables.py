"""[medium] and [[volume]] of a scene file: their keys, part of `toml_tables`."""

from __future__ import annotations

from dataclasses import replace

from .. import checks
from ..keys import Key, one_of
from .toml_keys import SEQUENCE_KEYS
from .toml_schema import COLOUR, PLACEMENT, UP, Table, mean_cosine, unit_rgb

_SCATTERING = (
    Key("sigma_t", checks.rgb, COLOUR, "extinction coefficient", "m^-1"),
    Key("albedo", unit_rgb, COLOUR, "sigma_s / sigma_t; only with sigma_t", default="1"),
    Key(
        "sigma_s",
        checks.rgb,
        COLOUR,
        "scattering coefficient, instead of sigma_t and albedo",
        "m^-1",
    ),
    Key("sigma_a", checks.rgb, COLOUR, "absorption coefficient, beside sigma_s", "m^-1", "0"),
    Key(
        "g",
        mean_cosine,
        COLOUR,
        "mean cosine of Henyey-Greenstein scattering, in (-1, 1); above 0 forwards",
        default="0",
    ),
)

_EMISSION = Key(
    "emission",
    checks.rgb,
    COLOUR,
    "light that it gives off itself, at density 1 and in proportion to it",
    "W m^-3 sr^-1",
    "0",
)

_COEFFICIENT_GRIDS = tuple(
    Key(
        f"{name}_grid",
        checks.text,
        "text",
        f"which of the file's named grids {meaning}; of one channel or of three",
    )
    for name, meaning in (
        (
            "sigma_t",
            "extinction is in proportion to, not the density; sigma_t is then 1",
        ),
        ("albedo", "`albedo` is multiplied with, voxel by voxel: `Cd`"),
        (
            "sigma_s",
            "scattering is in proportion to, not the density; sigma_s is then 1",
        ),
        (
            "sigma_a",
            "absorption is in proportion to, not the density; sigma_a is then 1",
        ),
        ("g", "holds the mean cosine, instead of `g`"),
    )
)

_EMISSION_GRIDS = (
    Key(
        "emission_grid",
        checks.text,
        "text",
        "which of the file's named grids the emission is in proportion to, instead of the density: "
        "`flame`, `heat`; then `emission` is 1 by default",
    ),
    Key(
        "temperature_grid",
        checks.text,
        "text",
        "which of them holds temperatures: the emission is that of black bodies, times `emission`, "
        "which is then in m^-1 and 1 by default",
    ),
    Key(
        "temperature_scale",
        checks.number,
        "number",
        "kelvin are (value - temperature_offset) * temperature_scale",
        default="1",
    ),
    Key("temperature_offset", checks.number, "number", "see temperature_scale", default="0"),
)

MEDIUM = Table(
    "medium",
    "A homogeneous medium. Without bounds it fills the scene's bounds, the camera included.",
    (
        *_SCATTERING,
        _EMISSION,
        Key("bounds", checks.bounds, "two corners", "the box it fills", "m"),
        Key(
            "endless",
            checks.boolean,
            "boolean",
            "it goes on sideways and downwards without an end",
            default="false",
        ),
        Key(
            "top",
            checks.number,
            "number",
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
            checks.text,
            "path",
            "a density grid: NumPy .npy or .npz, Mitsuba .vol, NanoVDB .nvdb, OpenVDB .vdb, VTK "
            ".vti, NetCDF .nc, .zarr",
        ),
        Key(
            "shape",
            one_of("box", "sphere"),
            '"box" or "sphere"',
            "instead of a file: fills its bounds with density 1",
        ),
        Key("grid", checks.text, "text", "which of a file's named grids", default='"density"'),
        Key(
            "channels",
            checks.text,
            "text",
            'which channel holds the density: "density" (the only one), "r", "g", "b" or "a"',
            default='"density"',
        ),
        Key(
            "bounds",
            checks.bounds,
            "two corners",
            "the world box that the grid or shape fills",
            "m",
            "the file's own",
        ),
        *SEQUENCE_KEYS,
        replace(UP, doc=f"{UP.doc}; NetCDF and zarr files say so themselves"),
        *PLACEMENT,
        *_SCATTERING,
        _EMISSION,
        *_EMISSION_GRIDS,
        *_COEFFICIENT_GRIDS,
        Key(
            "detail",
            checks.number,
            "number",
            "finer noise than the grid's where it is drawn; about its deviation at density 1",
            default="0",
        ),
    ),
    repeated=True,
)
