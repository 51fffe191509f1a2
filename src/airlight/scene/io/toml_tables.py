"""Scene file version 1: every table and key, its check, unit, default and meaning.

The loader checks a file against these tables, and `toml_page` prints the reference page from them,
so the two cannot drift apart.
"""

from __future__ import annotations

from ..keys import (
    BOOLEAN,
    COLOUR,
    FRACTION,
    LOCAL_DATE,
    LOCAL_TIME,
    NUMBER,
    PATH,
    REFLECTANCE,
    SIZE_PX,
    STOPS,
    TEXT,
    UNIT_VECTOR,
    VECTOR,
    Key,
    one_of,
    within,
)
from ..lights import TYPES
from ..material import SIDES
from .toml_keys import ANIMATION, BETWEEN, CLIP_KEYS
from .toml_media_tables import MEDIUM, VOLUME
from .toml_schema import PLACEMENT, UP, Table

_POSITION = Key("position", VECTOR, "where it is", "m", required=True)


CAMERA = Table(
    "camera",
    "The camera. Without the table, one is chosen that frames the scene, and where a default "
    "light is added it is exposed by the light that falls on the scene; in rooms by the image.",
    (
        _POSITION,
        Key("target", VECTOR, "the point it looks at", "m", required=True),
        Key("up", UNIT_VECTOR, "upwards in the image", default="[0, 1, 0]"),
        Key("fov_y_deg", NUMBER, "full vertical field of view", "degrees", "50"),
        Key(
            "exposure_stops",
            STOPS,
            'display exposure: 2^stops; "auto": from the image itself',
            "stops",
            "0",
        ),
        Key("aperture_m", NUMBER, "diameter of its lens; 0: a pinhole", "m", "0"),
        Key("focus_m", NUMBER, "how far ahead things are sharp", "m", "the target's distance"),
        Key(
            "shutter_s",
            NUMBER,
            "how long each frame's shutter is open while things move",
            "seconds",
            "0",
        ),
        Key(
            "film_px",
            SIZE_PX,
            "width and height of images where no other size is asked for",
            "px",
            "[1280, 720]",
        ),
        BETWEEN,
    ),
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
            PATH,
            "a mesh file: OBJ, glTF, GLB, PLY, STL or USD; Draco: airlight[gltf], USD: "
            "airlight[usd]",
        ),
        Key(
            "shape",
            one_of("box", "sphere", "plane", "quad"),
            "instead of a file: 1 m across, centred at the origin; quad and plane face +Y",
        ),
        UP,
        Key("variant", TEXT, "by name, one of a glTF file's material variants"),
        *PLACEMENT,
        Key("base_color", REFLECTANCE, "linear reflectance", default="the file's, or 0.8"),
        Key("roughness", FRACTION, "0 mirror, 1 matt", default="the file's, or 1"),
        Key("metallic", FRACTION, "0 dielectric, 1 metal", default="the file's, or 0"),
        Key(
            "specular",
            FRACTION,
            "scales what a dielectric mirrors, 4 % head on; 0 is perfectly matt",
            default="the file's, or 1",
        ),
        Key("emission", COLOUR, "radiance", "W m^-2 sr^-1", "the file's, or 0"),
        Key(
            "opacity",
            FRACTION,
            "the share of the surface that is there; the rest of the light passes",
            default="the file's, or 1",
        ),
        Key(
            "transmission",
            FRACTION,
            "thin glass: the share of what it does not mirror that passes, tinted by base_color",
            default="the file's, or 0",
        ),
        Key(
            "sides",
            one_of(*SIDES),
            "which sides reflect and emit: both, or the front, whose back is black, or which "
            "cameras look through from behind",
            default='the file\'s, or "both"',
        ),
        *CLIP_KEYS,
        BETWEEN,
    ),
    repeated=True,
)

_POINTS = (
    Key(
        "file",
        PATH,
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
        Key("type", one_of(*_LIGHT_KEYS), "its kind", required=True),
        BETWEEN,
    ),
    repeated=True,
    variant_key="type",
    variants=_LIGHT_KEYS,
)

ENVIRONMENT = Table(
    "environment",
    "Light from far away, all around. Without the table the background is black where the scene "
    "has a light or an emissive mesh; where it has none, a default light is added: a sun and a "
    "sky in rooms, for volumes alone and where hardly any of what is seen would be lit, a studio "
    "around all else. Suns in a map (at most some 2 degrees wide, at least "
    "3 % of its light, up to four) light the scene as directional lights do, with sharp shadows.",
    (
        Key(
            "file",
            PATH,
            "a latitude-longitude image: EXR, HDR, PNG or JPEG; or builtin:studio, the backdrop "
            "in which bare models are shown, as the scene's directional lights light it, those "
            "that move as they are at first",
        ),
        Key("radiance", COLOUR, "instead of a file: constant radiance", "W m^-2 sr^-1"),
        Key("scale", NUMBER, "multiplies it", default="1"),
        Key(
            "rotation_deg",
            NUMBER,
            "turns it about +Y, counter-clockwise from above",
            "degrees",
            "0",
        ),
        Key("visible", BOOLEAN, "false keeps its light, not its image", default="true"),
        BETWEEN,
    ),
)

SKY = Table(
    "sky",
    "A clear sky with its sun, computed: instead of an [environment]. The sun is a light of its "
    "own and seen as a disk. Say where it stands by angles, or by place and time. Radiances are "
    "those of the real sky (the sun gives some 500 W m^-2): without an exposure_stops the image is "
    "exposed by itself.",
    (
        Key("elevation_deg", NUMBER, "above the horizon, -18 to 90", "degrees"),
        Key("azimuth_deg", NUMBER, "from north (-Z) by east (+X)", "degrees"),
        Key("latitude_deg", NUMBER, "of the place, instead of angles", "degrees"),
        Key("longitude_deg", NUMBER, "of the place, eastwards", "degrees"),
        Key("date", LOCAL_DATE, "such as 2026-06-21, without quotes"),
        Key("time", LOCAL_TIME, "such as 17:30:00, without quotes"),
        Key(
            "utc_offset_h",
            within(-14.0, 14.0),
            "hours by which that clock is before UTC (in summer, too)",
            "hours",
            "the longitude's / 15, whole",
        ),
        Key("north_deg", NUMBER, "where the scene's north lies: from -Z by +X", "degrees", "0"),
        Key("turbidity", NUMBER, "haze, 1 to 10: 2 very clear, 3 clear, 6 hazy", default="2.5"),
        Key("ground", FRACTION, "albedo below the horizon", default="0.2"),
        Key("scale", NUMBER, "multiplies sun and sky", default="1"),
        Key("disk", BOOLEAN, "the sun is seen", default="true"),
    ),
)

TABLES: tuple[Table, ...] = (CAMERA, MESH, LIGHT, ENVIRONMENT, SKY, MEDIUM, VOLUME, ANIMATION)
