"""How a table of a scene file is described, and checked against its description."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import SceneError, nearest
from .. import checks
from ..keys import VECTOR, Key, Kind, one_of


@dataclass(frozen=True)
class Table:
    """A [name] table, or with `repeated` a [[name]] one.

    `variants` adds keys by the value of the key `variant_key`.
    """

    name: str
    doc: str
    keys: tuple[Key, ...]
    repeated: bool = False
    variant_key: str = ""
    variants: Mapping[str, tuple[Key, ...]] | None = None

    @property
    def header(self) -> str:
        """The table's line in a scene file."""
        return f"[[{self.name}]]" if self.repeated else f"[{self.name}]"


def _scale_vec3(value: Any, name: str) -> checks.Vec3:
    """One factor or three, none of them zero."""
    # A boolean is an integer in Python, and no factor.
    grey = isinstance(value, (int, float)) and not isinstance(value, bool)
    factors = checks.vec3([value] * 3 if grey else value, name)
    if 0.0 in factors:
        raise SceneError(f"{name} = {list(factors)} flattens the mesh: no factor may be zero")
    return factors


def _matrix16(value: Any, name: str) -> checks.F64:
    """Sixteen numbers, row major, as an invertible affine (4, 4) float64."""

    if not isinstance(value, list) or len(value) != 16:
        raise SceneError(f"{name} must be 16 numbers, row major")
    matrix = np.array([checks.number(v, name) for v in value]).reshape(4, 4)
    if matrix[3].tolist() != [0.0, 0.0, 0.0, 1.0]:
        raise SceneError(
            f"{name} ends with the row {matrix[3].tolist()}, it must be [0, 0, 0, 1]",
            remedy="Rows come first: the translation is the 4th, 8th and 12th number.",
        )
    if abs(np.linalg.det(matrix[:3, :3])) < 1e-30:
        raise SceneError(f"{name} flattens the mesh: its determinant is zero")
    return matrix


def _mean_cosine(value: Any, name: str) -> checks.Rgb:
    """g, one number or one per channel, each in (-1, 1)."""
    from ..medium import mean_cosine as checked

    try:
        return checked(value)
    except SceneError as error:
        raise SceneError(error.problem.replace("g", name, 1)) from None


def check_table(table: Table, raw: Any, label: str) -> dict[str, Any]:
    """The checked values of the keys that `raw` sets; `label` is the table's key path.

    Raises SceneError for an unknown or missing key, or a value of the wrong type or range.
    """
    if not isinstance(raw, dict):
        raise SceneError(f"{label} must be a table of keys, not {raw!r}")
    # Unknown keys first: a misspelt one is why another is missing.
    keys, of_variant = _keys_for(table, raw, label)
    known = {key.name: key for key in keys}
    for name in raw:
        if name not in known:
            raise SceneError(
                f"unknown key '{name}' in {label}{of_variant}", remedy=nearest(name, known)
            )
    # Then what has to be there, and the value of each key.
    for key in keys:
        if key.required and key.name not in raw:
            raise SceneError(f"{label}{of_variant} has no {key.name}", remedy=_explained(key))
    return {name: known[name].kind.check(value, f"{label}: {name}") for name, value in raw.items()}


def _keys_for(table: Table, raw: dict[str, Any], label: str) -> tuple[tuple[Key, ...], str]:
    """The keys that hold for `raw`, and words for the variant that it names."""
    if table.variants is None:
        return table.keys, ""
    # The variant's own keys are known only by the value that selects it.
    (selector,) = (key for key in table.keys if key.name == table.variant_key)
    if selector.name not in raw:
        raise SceneError(f"{label} has no {selector.name}", remedy=f"It is {selector.kind.words}.")
    variant = selector.kind.check(raw[selector.name], f"{label}: {selector.name}")
    return table.keys + table.variants[variant], f" ({variant})"


def _explained(key: Key) -> str:
    unit = f", {key.unit}" if key.unit else ""
    return f"It is {key.doc} ({key.kind.words}{unit})."


@contextmanager
def inside(label: str) -> Iterator[None]:
    """Put the key path before what a scene value says of itself."""
    try:
        yield
    except SceneError as error:
        if error.where or error.problem.startswith(label):
            raise
        raise SceneError(f"{label}: {error.problem}", remedy=error.remedy) from None


MEAN_COSINE = Kind("colour", _mean_cosine)
SCALE = Kind("number or vector", _scale_vec3)
MATRIX = Kind("16 numbers", _matrix16)

UP = Key(
    "up",
    one_of("y", "z"),
    "which axis of the file points upwards; it is turned before anything else",
    default='"y"',
)

PLACEMENT = (
    Key("translate", VECTOR, "moves it", "m", "[0, 0, 0]"),
    Key("rotate_deg", VECTOR, "turns it: X, Y, Z", "degrees", "[0, 0, 0]"),
    Key("scale", SCALE, "stretches it", default="1"),
    Key("matrix", MATRIX, "instead of those three: 4 x 4, row major"),
)
"""Where a mesh or a volume stands."""
