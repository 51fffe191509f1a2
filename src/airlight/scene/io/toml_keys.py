"""Scene file version 1: what moves. Keyframes stand under the table of what they move."""

from __future__ import annotations

from .. import checks
from ..keys import BOOLEAN, NUMBER, PATH, TEXT, UNIT_VECTOR, VECTOR, Key, Kind, one_of, within
from ..lights import TYPES
from .toml_schema import SCALE, Table

TIME = Key("time_s", NUMBER, "when", "seconds", required=True)


_ABOVE_ZERO = within(1e-6, 1e6)
_METERED = within(-checks.MOST_STOPS, checks.MOST_STOPS)  # between keyframes there is no "auto"


def _key(name: str, kind: Kind, unit: str = "") -> Key:
    return Key(name, kind, "as in the table above it", unit)


_POSITION = _key("position", VECTOR, "m")

ANIMATION = Table(
    "animation",
    "The time that a sequence shows. What moves stands under what it moves: `[[camera.key]]`, "
    "`[[light.key]]` after its `[[light]]`, `[[mesh.key]]` after its `[[mesh]]`, "
    "`[[environment.key]]`; density sequences are volumes. Before the first and after the last "
    "keyframe their values hold. A key that one of a table's keyframes sets, all of them set.",
    (
        Key("start_s", NUMBER, "the first frame's time", "seconds", "0"),
        Key("end_s", NUMBER, "when it ends", "seconds", "the last keyframe"),
        Key("fps", _ABOVE_ZERO, "frames per second", "s^-1", "24"),
        Key("loop", BOOLEAN, "time goes round", default="false"),
    ),
)

BETWEEN = Key(
    "between",
    one_of("smooth", "linear", "step"),
    'how keyframes are joined; "smooth": Catmull-Rom',
    default='"smooth"',
)
"""Stands in the table that has keyframes."""

KEYS: dict[str, Table] = {
    "camera": Table(
        "camera.key",
        "A keyframe of the camera.",
        (
            TIME,
            _POSITION,
            _key("target", VECTOR, "m"),
            _key("up", UNIT_VECTOR),
            _key("fov_y_deg", NUMBER, "degrees"),
            _key("exposure_stops", _METERED, "stops"),
        ),
        repeated=True,
    ),
    "mesh": Table(
        "mesh.key",
        "A keyframe of the last `[[mesh]]`: moves all that it brought. Not beside `matrix`.",
        (
            TIME,
            _key("translate", VECTOR, "m"),
            _key("rotate_deg", VECTOR, "degrees"),
            _key("scale", SCALE),
        ),
        repeated=True,
    ),
    "light": Table(
        "light.key",
        "A keyframe of the last `[[light]]`, with the keys of its type.",
        (TIME,),
        repeated=True,
        variant_key="type",
        variants={
            name: tuple(_key(key.name, key.kind, key.unit) for key in cls.keys if key.moves)
            for name, cls in TYPES.items()
        },
    ),
    "environment": Table(
        "environment.key",
        "A keyframe of the environment.",
        (
            TIME,
            _key("rotation_deg", NUMBER, "degrees"),
            _key("scale", NUMBER),
        ),
        repeated=True,
    ),
}
"""By the table that the keyframes stand under."""

CLIP_KEYS = (
    Key("clip", TEXT, "which animation of the file", default="its first"),
    Key("clip_start_s", NUMBER, "when it starts", "seconds", "0"),
    Key("clip_speed", _ABOVE_ZERO, "how fast it runs", default="1"),
    Key("clip_loop", BOOLEAN, "over and over", default="false"),
)
"""Of a [[mesh]] whose file is animated."""

SEQUENCE_KEYS = (
    Key(
        "sequence",
        PATH,
        "instead of a file: many, one after the other; a folder, or a pattern with `*`, sorted by "
        "the numbers in their names, .vti by their TimeValue where all have one",
    ),
    Key("sequence_fps", _ABOVE_ZERO, "files, or their times, per second", "s^-1", "24"),
    Key("sequence_start_s", NUMBER, "the first file's time", "seconds", "0"),
    Key("sequence_loop", BOOLEAN, "over and over", default="false"),
    Key(
        "between",
        one_of("linear", "step"),
        'between two files: mixed, or the earlier one ("step")',
        default='"linear"',
    ),
)
"""Of a [[volume]] that changes."""
