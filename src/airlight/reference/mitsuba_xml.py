"""The few kinds of element a Mitsuba scene is written with."""

from __future__ import annotations

from collections.abc import Iterable
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from numpy.typing import NDArray

from ..scene.checks import Rgb, Vec3


def plugin(tag: str, kind: str, name: str = "", *, id: str = "") -> Element:
    """<tag type="kind" name=... id=...>."""
    node = Element(tag, {"type": kind})
    if name:
        node.set("name", name)
    if id:
        node.set("id", id)
    return node


def numbers(values: Iterable[float]) -> str:
    """Comma-separated, enough digits to give every float32 back."""
    return ", ".join(f"{float(v):.9g}" for v in values)


def add_number(parent: Element, name: str, value: float) -> None:
    """<float>, with digits enough for a float32."""
    SubElement(parent, "float", {"name": name, "value": f"{float(value):.9g}"})


def add_integer(parent: Element, name: str, value: int | str) -> None:
    """<integer>; a $parameter stays text."""
    SubElement(parent, "integer", {"name": name, "value": str(value)})


def add_text(parent: Element, name: str, value: str) -> None:
    """<string>."""
    SubElement(parent, "string", {"name": name, "value": value})


def add_truth(parent: Element, name: str, value: bool) -> None:
    """<boolean>."""
    SubElement(parent, "boolean", {"name": name, "value": "true" if value else "false"})


def add_rgb(parent: Element, name: str, value: Rgb) -> None:
    """A linear Rec.709 triple; in Mitsuba's RGB variants it is taken as it is."""
    SubElement(parent, "rgb", {"name": name, "value": numbers(value)})


def add_xyz(parent: Element, kind: str, name: str, value: Vec3) -> None:
    """<point>, m, or <vector>: the `kind`."""
    x, y, z = (f"{float(v):.9g}" for v in value)
    SubElement(parent, kind, {"name": name, "x": x, "y": y, "z": z})


def add_matrix(parent: Element, name: str, matrix: NDArray[np.float64]) -> None:
    """A row-major 4x4 transform."""
    transform = SubElement(parent, "transform", {"name": name})
    values = " ".join(f"{v:.12g}" for v in np.asarray(matrix, dtype=np.float64).ravel())
    SubElement(transform, "matrix", {"value": values})


def add_lookat(parent: Element, name: str, origin: Vec3, target: Vec3, up: Vec3) -> None:
    """<transform> that looks from origin to target."""
    transform = SubElement(parent, "transform", {"name": name})
    keys = {"origin": numbers(origin), "target": numbers(target), "up": numbers(up)}
    SubElement(transform, "lookat", keys)


def add_reference(parent: Element, id: str, name: str = "") -> None:
    """<ref id=...>, `name` saying which role it plays (interior, exterior)."""
    SubElement(parent, "ref", {"id": id, **({"name": name} if name else {})})
