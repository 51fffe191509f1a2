"""Uniform and storage structs, declared once: a NumPy dtype and a WGSL struct from one class.

class MarchParams(Struct):
    world_from_clip = mat4x4f()
    sigma_t = vec3f("m^-1")

Offsets follow WGSL's rules for host-shareable structs (alignment 4, 8 or 16).
"""

from __future__ import annotations

from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

_MOST_KEPT = 256


class Field:
    """A WGSL type with the unit of what it holds."""

    def __init__(
        self, wgsl: str, dtype: type, shape: tuple[int, ...], align: int, unit: str
    ) -> None:
        self.wgsl, self.dtype, self.shape, self.align, self.unit = wgsl, dtype, shape, align, unit

    @property
    def size(self) -> int:
        """Bytes."""
        return 4 * int(np.prod(self.shape, dtype=int))


def f32(unit: str = "") -> Field:
    """A float."""
    return Field("f32", np.float32, (), 4, unit)


def u32(unit: str = "") -> Field:
    """An unsigned integer."""
    return Field("u32", np.uint32, (), 4, unit)


def i32(unit: str = "") -> Field:
    """A signed integer."""
    return Field("i32", np.int32, (), 4, unit)


def vec2f(unit: str = "") -> Field:
    """Two floats."""
    return Field("vec2f", np.float32, (2,), 8, unit)


def vec3f(unit: str = "") -> Field:
    """Three floats."""
    return Field("vec3f", np.float32, (3,), 16, unit)


def vec4f(unit: str = "") -> Field:
    """Four floats."""
    return Field("vec4f", np.float32, (4,), 16, unit)


def vec2u(unit: str = "") -> Field:
    """Two unsigned integers."""
    return Field("vec2u", np.uint32, (2,), 8, unit)


def vec3u(unit: str = "") -> Field:
    """Three unsigned integers."""
    return Field("vec3u", np.uint32, (3,), 16, unit)


def vec4u(unit: str = "") -> Field:
    """Four unsigned integers."""
    return Field("vec4u", np.uint32, (4,), 16, unit)


def mat4x4f(unit: str = "") -> Field:
    """A 4x4 matrix; NumPy's rows are stored as WGSL's columns."""
    return Field("mat4x4f", np.float32, (4, 4), 16, unit)


class Struct:
    """Base of all structs; subclasses list `Field`s. An instance packs one set of values.

    `of` gives one instance for the same values: what stays the same from frame to frame, or from
    dispatch to dispatch, is packed once.
    """

    dtype: ClassVar[np.dtype[Any]]
    wgsl: ClassVar[str]
    fields: ClassVar[dict[str, Field]]
    _kept: ClassVar[dict[tuple[Any, ...], Any]]

    def __init_subclass__(cls) -> None:
        cls.fields = {k: v for k, v in vars(cls).items() if isinstance(v, Field)}
        cls._kept = {}
        # Each field at the next multiple of its alignment, the size one of the largest: WGSL's
        # rules for structs.
        offsets, end = [], 0
        for field in cls.fields.values():
            offset = -(-end // field.align) * field.align
            offsets.append(offset)
            end = offset + field.size
        align = max(field.align for field in cls.fields.values())
        # The same layout for NumPy and as WGSL.
        cls.dtype = np.dtype(
            {
                "names": list(cls.fields),
                "formats": [(f.dtype, f.shape) for f in cls.fields.values()],
                "offsets": offsets,
                "itemsize": -(-end // align) * align,
            }
        )
        members = "".join(
            f"    {name}: {field.wgsl},{f'  // {field.unit}' if field.unit else ''}\n"
            for name, field in cls.fields.items()
        )
        cls.wgsl = f"struct {cls.__name__} {{\n{members}}}\n"

    def __init__(self, **values: Any) -> None:
        self.record: NDArray[Any] = pack(type(self), values, np.zeros((), self.dtype))
        self.data: bytes = self.record.tobytes()

    @classmethod
    def of(cls, **values: Any) -> Self:
        """The instance of these values, which must be hashable: numbers and tuples of numbers."""
        # Equal values are one instance, so that they are packed and stored once.
        key = tuple(values.items())
        found: Self | None = cls._kept.get(key)
        if found is None:
            found = cls(**values)
            if len(cls._kept) >= _MOST_KEPT:
                cls._kept.clear()
            cls._kept[key] = found
        return found


def pack(cls: type[Struct], values: dict[str, Any], record: Any) -> Any:
    """Write `values` into a record of `cls.dtype`; refuse missing and unknown names."""
    if values.keys() != cls.fields.keys():
        missing = sorted(cls.fields.keys() - values.keys())
        unknown = sorted(values.keys() - cls.fields.keys())
        raise TypeError(f"{cls.__name__}: missing {missing}, unknown {unknown}")

    # NumPy's rows become WGSL's columns.
    for name, value in values.items():
        transposed = len(cls.fields[name].shape) == 2
        record[name] = np.transpose(value) if transposed else value
    return record


def pack_array(cls: type[Struct], rows: list[dict[str, Any]]) -> NDArray[Any]:
    """An array of structs, one per row; never empty, since WebGPU binds no empty buffer."""
    packed = np.zeros(max(1, len(rows)), cls.dtype)
    for record, row in zip(packed, rows, strict=False):
        pack(cls, row, record)
    return packed
