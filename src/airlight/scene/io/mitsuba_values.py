"""The values in Mitsuba's XML: numbers, colours, vectors and transforms."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np

from ...errors import SceneError
from ...maths.colour import srgb_decode
from ...maths.observer import FIRST_NM, LAST_NM
from ...maths.spectra import emitted, reflected
from ...maths.transforms import triple
from ..checks import F64, Rgb

VALUE_TAGS = frozenset(
    (
        "float",
        "integer",
        "boolean",
        "string",
        "rgb",
        "srgb",
        "spectrum",
        "point",
        "vector",
        "transform",
    )
)


class Spectrum(tuple[float, float, float]):
    """A linear Rec.709 triple of what reflects, made of wavelengths; `emitted`, if they are light.

    `is_reduced`: of values that differ by wavelength, so not quite what was meant.
    """

    emitted: Rgb
    is_reduced: bool


def parse_value(element: Element, where: Path) -> Any:
    """The value of one element of VALUE_TAGS.

    float, int, bool, str, (3,) tuples, and (4, 4) float64 for transforms. Raises SceneError.
    """
    tag, name = element.tag, element.get("name", "")
    label = f"<{tag} name='{name}'>"
    text = element.get("value", "")
    # Scalars, each checked for its kind.
    if tag == "float":
        return _number(text, label, where)
    if tag == "integer":
        value = _number(text, label, where)
        if value != int(value):
            raise SceneError(f"{label} is '{text}', not a whole number", where=where)
        return int(value)
    if tag == "boolean":
        if text.lower() not in ("true", "false"):
            raise SceneError(f"{label} is '{text}', it must be true or false", where=where)
        return text.lower() == "true"
    if tag == "string":
        return text
    # Colours; all other values are points and vectors.
    if tag in ("rgb", "srgb"):
        return _color(text, tag, label, where)
    if tag == "spectrum":
        return _spectrum(element, label, where)
    if tag == "transform":
        return _transform(element, where)
    return _vector(element, 0.0, label, where)


def _number(text: str, label: str, where: Path) -> float:
    try:
        value = float(text)
    except ValueError:
        raise SceneError(f"{label} is '{text}', not a number", where=where) from None
    if not math.isfinite(value):
        raise SceneError(f"{label} is {text}, it must be finite", where=where)
    return value


def _numbers(text: str, label: str, where: Path) -> list[float]:
    return [_number(part, label, where) for part in re.split(r"[\s,]+", text.strip()) if part]


def _color(text: str, tag: str, label: str, where: Path) -> Rgb:
    # Hexadecimal colours are sRGB-encoded by definition, plain numbers linear unless the tag says
    # sRGB.
    match = re.fullmatch(r"#([0-9a-fA-F]{6})", text.strip())
    if match:
        values = [int(match.group(1)[k : k + 2], 16) / 255.0 for k in (0, 2, 4)]
        tag = "srgb"
    else:
        values = _numbers(text, label, where)
    # One number is grey.
    if len(values) == 1:
        values *= 3
    if len(values) != 3:
        raise SceneError(f"{label} has {len(values)} numbers, it must have 1 or 3", where=where)
    if tag == "srgb":
        values = [float(v) for v in srgb_decode(values)]
    return (values[0], values[1], values[2])


def _spectrum(element: Element, label: str, where: Path) -> Rgb:
    """A triple, or wavelength:value pairs, or a constant, seen as a colour."""
    text = element.get("value", "")
    if element.get("filename"):
        raise SceneError(f"{label}: spectra in files are not read", where=where)
    # A constant is grey where it reflects, and where it is light a little red.
    if ":" not in text:
        made = Spectrum(_color(text, "rgb", label, where))
        made.emitted, made.is_reduced = made, False
        if len(set(made)) == 1:
            made.emitted = triple(made[0] * emitted([FIRST_NM, LAST_NM], [1.0, 1.0]))
        return made
    # Wavelengths need not be in order in the file.
    pairs = [part.partition(":") for part in re.split(r"[\s,]+", text.strip()) if part]
    known = sorted((_number(a, label, where), _number(b, label, where)) for a, _, b in pairs)
    wavelengths, values = zip(*known, strict=True)
    made = Spectrum(triple(reflected(wavelengths, values)))
    made.emitted, made.is_reduced = triple(emitted(wavelengths, values)), True
    return made


def _vector(
    element: Element, default: float, label: str, where: Path
) -> tuple[float, float, float]:
    # Three numbers in one attribute, or one in each of x, y and z.
    if element.get("value") is not None:
        values = _numbers(element.get("value", ""), label, where)
        if len(values) == 1:
            values *= 3
        if len(values) != 3:
            raise SceneError(f"{label} must have three numbers", where=where)
        return (values[0], values[1], values[2])
    x, y, z = (_number(element.get(axis, str(default)), label, where) for axis in "xyz")
    return (x, y, z)


def _transform(element: Element, where: Path) -> F64:
    """The product of the steps, the first one applied first."""
    matrix = np.eye(4)
    for step in element:
        matrix = _step(step, where) @ matrix
    return matrix


def _step(step: Element, where: Path) -> F64:
    label = f"<{step.tag}>"
    if step.tag == "translate":
        matrix = np.eye(4)
        matrix[:3, 3] = _vector(step, 0.0, label, where)
        return matrix
    if step.tag == "scale":
        return np.diag([*_vector(step, 1.0, label, where), 1.0])
    if step.tag == "rotate":
        axis = np.array(_vector(step, 0.0, label, where))
        return rotation(axis, _number(step.get("angle", ""), f"{label} angle", where), where)
    if step.tag == "lookat":
        return _lookat(step, where)
    if step.tag == "matrix":
        return _matrix(_numbers(step.get("value", ""), label, where), where)
    raise SceneError(f"<{step.tag}> is no step of a transform", where=where)


def _matrix(values: list[float], where: Path) -> F64:
    if len(values) not in (9, 16):
        raise SceneError(f"a matrix has {len(values)} numbers, it must have 9 or 16", where=where)
    side = math.isqrt(len(values))
    matrix = np.eye(4)
    matrix[:side, :side] = np.reshape(values, (side, side))
    return matrix


def rotation(axis: F64, angle_deg: float, where: object = "") -> F64:
    """Counter-clockwise about `axis` by `angle_deg`, 4x4 (Rodrigues)."""
    length = float(np.linalg.norm(axis))
    if length == 0.0:
        raise SceneError("a rotation's axis is zero", where=where)
    x, y, z = axis / length
    # The matrix of the cross product with the axis.
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = math.radians(angle_deg)
    matrix = np.eye(4)
    matrix[:3, :3] += math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    return matrix


def _lookat(step: Element, where: Path) -> F64:
    """Columns left, up, forward, origin: Mitsuba's cameras and spots look along +Z."""
    # Three points, of which the last may be left out.
    origin, target, up = (
        np.array((_numbers(step.get(key, ""), f"<lookat {key}>", where) or [0, 0, 0])[:3])
        for key in ("origin", "target", "up")
    )
    if any(len(v) != 3 for v in (origin, target, up)):
        raise SceneError("<lookat> needs origin and target of three numbers", where=where)
    forward = target - origin
    if not np.any(forward):
        raise SceneError("<lookat> has its target at its origin", where=where)
    # Three axes at right angles.
    forward = forward / np.linalg.norm(forward)
    left = np.cross(up, forward)
    # An up along the view says nothing of it: any other one will do.
    if np.linalg.norm(left) < 1e-9:
        left = np.cross((0.0, 1.0, 0.0) if abs(forward[1]) < 0.9 else (1.0, 0.0, 0.0), forward)
    left = left / np.linalg.norm(left)
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 1] = left, np.cross(forward, left)
    matrix[:3, 2], matrix[:3, 3] = forward, origin
    return matrix
