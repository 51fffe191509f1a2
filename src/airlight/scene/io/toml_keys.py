"""Scene file version 1: what moves. Keyframes stand under the table of what they move."""

from __future__ import annotations

from .. import checks
from ..keys import Check, Key, one_of
from ..lights import TYPES
from .toml_schema import Table, scale_vec3

TIME = Key("time_s", checks.number, "number", "when", "seconds", required=True)


def above_zero(value: float, name: str) -> float:
    """A number above zero, at most a million."""
    return checks.number(value, name, low=1e-6, high=1e6)


def metered(value: object, name: str) -> float:
    """Stops of exposure as a number: between keyframes there is no "auto"."""
    return checks.number(value, name, low=-checks.MOST_STOPS, high=checks.MOST_STOPS)


def _key(name: str, check: Check, kind: str, unit: str = "") -> Key:
    return Key(name, check, kind, "as in the table above it", unit)


_POSITION = _key("position", checks.vec3, "vector", "m")

ANIMATION = Table(
    "animation",
    "The time that a sequence shows. What moves stands under what it moves: `[[camera.key]]`, "
    "`[[light.key]]` after its `[[light]]`, `[[mesh.key]]` after its `[[mesh]]`, "
    "`[[environment.key]]`; density sequences are volumes. Before the first and after the last "
    "keyframe their values hold. A key that one of a table's keyframes sets, all of them set.",
    (
        Key("start_s", checks.number, "number", "the first frame's time", "seconds", "0"),
        Key("end_s", checks.number, "number", "when it ends", "seconds", "the last keyframe"),
        Key("fps", above_zero, "number", "frames per second", "s^-1", "24"),
        Key("loop", checks.boolean, "boolean", "time goes round", default="false"),
    ),
)

BETWEEN = Key(
    "between",
    one_of("smooth", "linear", "step"),
    '"smooth", "linear" or "step"',
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
            _key("target", checks.vec3, "vector", "m"),
            _key("up", checks.unit_vec3, "vector"),
            _key("fov_y_deg", checks.number, "number", "degrees"),
            _key("exposure_stops", metered, "number", "stops"),
        ),
        repeated=True,
    ),
    "mesh": Table(
        "mesh.key",
        "A keyframe of the last `[[mesh]]`: moves all that it brought. Not beside `matrix`.",
        (
            TIME,
            _key("translate", checks.vec3, "vector", "m"),
            _key("rotate_deg", checks.vec3, "vector", "degrees"),
            _key("scale", scale_vec3, "number or vector"),
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
            name: tuple(
                _key(key.name, key.check, key.kind, key.unit) for key in cls.keys if key.moves
            )
            for name, cls in TYPES.items()
        },
    ),
    "environment": Table(
        "environment.key",
        "A keyframe of the environment.",
        (
            TIME,
            _key("rotation_deg", checks.number, "number", "degrees"),
            _key("scale", checks.number, "number"),
        ),
        repeated=True,
    ),
}
"""By the table that the keyframes stand under."""

CLIP_KEYS = (
    Key("clip", checks.text, "text", "which animation of the file", default="its first"),
    Key("clip_start_s", checks.number, "number", "when it starts", "seconds", "0"),
    Key("clip_speed", above_zero, "number", "how fast it runs", default="1"),
    Key("clip_loop", checks.boolean, "boolean", "over and over", default="false"),
)
"""Of a [[mesh]] whose file is animated."""

SEQUENCE_KEYS = (
    Key(
        "sequence",
        checks.text,
        "path",
        "instead of a file: many, one after the other; a folder, or a pattern with `*`, sorted by "
        "the numbers in their names, .vti by their TimeValue where all have one",
    ),
    Key("sequence_fps", above_zero, "number", "files, or their times, per second", "s^-1", "24"),
    Key("sequence_start_s", checks.number, "number", "the first file's time", "seconds", "0"),
    Key("sequence_loop", checks.boolean, "boolean", "over and over", default="false"),
    Key(
        "between",
        one_of("linear", "step"),
        '"linear" or "step"',
        'between two files: mixed, or the earlier one ("step")',
        default='"linear"',
    ),
)
"""Of a [[volume]] that changes."""
