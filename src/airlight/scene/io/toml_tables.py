"""Scene file version 1: every table and key, its check, unit, default and meaning.

The loader checks a file against these tables, and the reference page is printed from them, so
the two cannot drift apart.
"""

from __future__ import annotations

from .. import checks
from ..keys import Key, one_of
from ..lights import TYPES
from .toml_keys import (
    ANIMATION,
    BETWEEN,
    CLIP_KEYS,
    KEYS,
    SEQUENCE_KEYS,
)
from .toml_schema import (
    Table,
    fraction,
    matrix16,
    mean_cosine,
    scale_vec3,
    unit_rgb,
)
from .toml_sky_keys import SKY

_COLOUR = "colour"
_POSITION = Key("position", checks.vec3, "vector", "where it is", "m", required=True)


def _choice(*names: str) -> str:
    """Words for one of `names`."""
    quoted = [f'"{name}"' for name in names]
    return f"{', '.join(quoted[:-1])} or {quoted[-1]}"


CAMERA = Table(
    "camera",
    "The camera. Without the table, one is chosen that frames the scene and is exposed by "
    "the image.",
    (
        _POSITION,
        Key("target", checks.vec3, "vector", "the point it looks at", "m", required=True),
        Key("up", checks.unit_vec3, "vector", "upwards in the image", default="[0, 1, 0]"),
        Key("fov_y_deg", checks.number, "number", "full vertical field of view", "degrees", "50"),
        Key(
            "exposure_stops",
            checks.stops,
            'number or "auto"',
            'display exposure: 2^stops; "auto": from the image itself, as without it where a '
            "default sun is added",
            "stops",
            "0",
        ),
        Key("aperture_m", checks.number, "number", "diameter of its lens; 0: a pinhole", "m", "0"),
        Key(
            "focus_m",
            checks.number,
            "number",
            "how far ahead things are sharp",
            "m",
            "the target's distance",
        ),
        Key(
            "shutter_s",
            checks.number,
            "number",
            "how long each frame's shutter is open while things move",
            "seconds",
            "0",
        ),
        BETWEEN,
    ),
)

MODEL_KEYS = (
    Key(
        "up",
        one_of("y", "z"),
        '"y" or "z"',
        "which axis of the file points upwards; it is turned before anything else",
        default='"y"',
    ),
    Key("variant", checks.text, "text", "by name, one of a glTF file's material variants"),
)
_PLACEMENT = (
    Key("translate", checks.vec3, "vector", "moves it", "m", "[0, 0, 0]"),
    Key("rotate_deg", checks.vec3, "vector", "turns it: X, Y, Z", "degrees", "[0, 0, 0]"),
    Key("scale", scale_vec3, "number or vector", "stretches it", default="1"),
    Key("matrix", matrix16, "16 numbers", "instead of those three: 4 x 4, row major"),
)

MESH = Table(
    "mesh",
    "Triangles: a file's, or a shape's. A file's own lights come along, moved with it; its camera "
    "is used where the scene file has no [camera]. A point is scaled first, then rotated about "
    "the world's X axis, then Y, then Z, then translated. The colours here replace those of the "
    "file's materials, textures included; masks stay, and an opacity multiplies them.",
    (
        Key(
            "file",
            checks.text,
            "path",
            "a mesh file: OBJ, glTF, GLB, PLY or STL; Draco: airlight[gltf]",
        ),
        Key(
            "shape",
            one_of("box", "sphere", "plane", "quad"),
            '"box", "sphere", "plane" or "quad"',
            "instead of a file: 1 m across, centred at the origin; quad and plane face +Y",
        ),
        *MODEL_KEYS,
        *_PLACEMENT,
        Key("base_color", unit_rgb, _COLOUR, "linear reflectance", default="the file's, or 0.8"),
        Key("roughness", fraction, "number", "0 mirror, 1 matt", default="the file's, or 1"),
        Key("metallic", fraction, "number", "0 dielectric, 1 metal", default="the file's, or 0"),
        Key("emission", checks.rgb, _COLOUR, "radiance", "W m^-2 sr^-1", "the file's, or 0"),
        Key(
            "opacity",
            fraction,
            "number",
            "the share of the surface that is there; the rest of the light passes",
            default="the file's, or 1",
        ),
        Key(
            "transmission",
            fraction,
            "number",
            "thin glass: the share of what it does not mirror that passes, tinted by base_color",
            default="the file's, or 0",
        ),
        *CLIP_KEYS,
        BETWEEN,
    ),
    repeated=True,
)

_POINTS = (
    Key(
        "file",
        checks.text,
        "path",
        "an .npz file of `positions` (N, 3), metres, and `intensities` (N, 3), W sr^-1: "
        "lights by the thousand, without sharp shadows, in techniques with a lattice",
        required=True,
    ),
)
_LIGHT_KEYS: dict[str, tuple[Key, ...]] = {
    **{name: cls.keys for name, cls in TYPES.items()},
    "points": _POINTS,
}

LIGHT = Table(
    "light",
    "A light. Meshes with emission are area lights, too, without a table of their own.",
    (
        Key("type", one_of(*_LIGHT_KEYS), _choice(*_LIGHT_KEYS), "its kind", required=True),
        BETWEEN,
    ),
    repeated=True,
    variant_key="type",
    variants=_LIGHT_KEYS,
)

ENVIRONMENT = Table(
    "environment",
    "Light from far away, all around. Without the table the background is black where the scene "
    "has a light or an emissive mesh; where it has none, a default sun and sky are added. Suns in "
    "a map (at most some 2 degrees wide, at least 3 % of its light, up to four) light the scene "
    "as directional lights do, with sharp shadows.",
    (
        Key("file", checks.text, "path", "a latitude-longitude image: EXR, HDR, PNG or JPEG"),
        Key(
            "radiance", checks.rgb, _COLOUR, "instead of a file: constant radiance", "W m^-2 sr^-1"
        ),
        Key("scale", checks.number, "number", "multiplies it", default="1"),
        Key(
            "rotation_deg",
            checks.number,
            "number",
            "turns it about +Y, counter-clockwise from above",
            "degrees",
            "0",
        ),
        Key(
            "visible",
            checks.boolean,
            "boolean",
            "false keeps its light, not its image",
            default="true",
        ),
        BETWEEN,
    ),
)

_SCATTERING = (
    Key("sigma_t", checks.rgb, _COLOUR, "extinction coefficient", "m^-1"),
    Key("albedo", unit_rgb, _COLOUR, "sigma_s / sigma_t; only with sigma_t", default="1"),
    Key(
        "sigma_s",
        checks.rgb,
        _COLOUR,
        "scattering coefficient, instead of sigma_t and albedo",
        "m^-1",
    ),
    Key("sigma_a", checks.rgb, _COLOUR, "absorption coefficient, beside sigma_s", "m^-1", "0"),
    Key(
        "g",
        mean_cosine,
        _COLOUR,
        "mean cosine of Henyey-Greenstein scattering, in (-1, 1); above 0 forwards",
        default="0",
    ),
)

_EMISSION = Key(
    "emission",
    checks.rgb,
    _COLOUR,
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
    "density 1. It is placed as a mesh is, after its bounds. A scene may have 256 media, its "
    "[medium] included; they may overlap.",
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
        *_PLACEMENT,
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

TABLES: tuple[Table, ...] = (CAMERA, MESH, LIGHT, ENVIRONMENT, SKY, MEDIUM, VOLUME, ANIMATION)


def schema_markdown() -> str:
    """The scene-file reference page: one section per table, one row per key."""
    parts = [_PREAMBLE]
    for table in (*TABLES, *KEYS.values()):
        parts.append(f"## `{table.header}`\n\n{table.doc}\n\n{_rows(table.keys)}")
        for name, keys in (table.variants or {}).items():
            parts.append(f'With `{table.variant_key} = "{name}"`:\n\n{_rows(keys)}')
    parts.append(_TECHNIQUE)
    return "\n\n".join(parts) + "\n"


def _rows(keys: tuple[Key, ...]) -> str:
    lines = ["| key | value | unit | default | meaning |", "|---|---|---|---|---|"]
    for key in keys:
        default = "**required**" if key.required else key.default
        cells = (f"`{key.name}`", key.kind, key.unit, default, key.doc)
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


_PREAMBLE = """\
# Scene file, version 1

A TOML file. Every key is checked; an unknown one is refused with the nearest known name. Paths \
are relative to the scene file. Vectors are arrays of three numbers, a colour is three linear \
Rec.709 numbers or one for grey. Right-handed, +Y up, metres. Directions are those \
of travel: away from the light.

A scene file may name any file of the machine, because its author is its user. What comes from \
elsewhere may not: a glTF's buffers and images, and all that a Mitsuba XML names, must lie in that \
file's own folder or below it, links followed; an OBJ's materials and textures are found by \
relative paths alone. Only \
regular files are read, no pipes, sockets or devices, and a file that claims to unpack to far \
more than its size bears out is refused.

Numbers are at most 1e15, positions and sizes 1e9 m, and a scene reaches at most 1e8 m from the \
origin: beyond, single precision has no image of it.

This page is printed from the loader's own table by `./run docs`."""

_TECHNIQUE = """\
## `[technique.NAME]`

Settings of the technique NAME, the same names as `-D key=value` and the Python fields."""
