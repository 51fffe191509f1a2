"""Lights in Mitsuba's terms, as values: plugins with parameters, before they are written."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, field

from ..checks import F32, F64, Rgb, Vec3


@dataclass(frozen=True)
class Point:
    """<point>, m."""

    at: Vec3


@dataclass(frozen=True)
class Vector:
    """<vector>."""

    along: Vec3


@dataclass(frozen=True)
class Colour:
    """<rgb>, linear Rec.709."""

    rgb: Rgb


@dataclass(frozen=True)
class LookAt:
    """<lookat>."""

    origin: Vec3
    target: Vec3
    up: Vec3


@dataclass(frozen=True)
class ImageFile:
    """The name of a file of linear pixels (H, W, 3); one file for all that have the same `key`."""

    key: Hashable
    stem: str
    pixels: Callable[[], F32]


Value = float | bool | str | Point | Vector | Colour | LookAt | ImageFile | F64
"""Of a parameter; an array is a (4, 4) matrix."""


@dataclass(frozen=True)
class Emitter:
    """<tag type=kind name=...> with its parameters, then the plugins inside it.

    `mark`: the beginning of its id, by which `scene.io.mitsuba_emitters` knows it again.
    """

    tag: str
    kind: str
    values: Mapping[str, Value]
    inner: tuple[Emitter, ...] = field(default=())
    name: str = ""
    mark: str = ""
