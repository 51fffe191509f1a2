"""Rows of four words in textures, for shaders whose invocations each read rows of their own.

Tables of structs are such rows, too: what media, nodes and triangles are. CPU adapters take a row
of a texture in a quarter of the time that one of a buffer takes, which they read word by word and
invocation by invocation. A row lies in a texel, LINE of them in a line of the texture.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .device import Gpu
from .layout import Field, Struct
from .memory import Texture
from .slots import Slot, texture

LINE = 2048
"""Rows in a line of a texture."""
_ROW_BYTES = 16
_KINDS = {"f": "f32", "u": "u32", "i": "i32"}


class Rows:
    """`count` rows, which passes bind."""

    def __init__(self, gpu: Gpu, label: str, count: int) -> None:
        """Raises DeviceError where the device has no texture of so many lines."""
        self._texture = Texture(gpu, label, (LINE, max(1, -(-count // LINE))), "rgba32uint")
        self.nbytes, self.resource = self._texture.nbytes, self._texture.resource

    @property
    def handle(self) -> Any:
        """The device's texture; None once it is released."""
        return self._texture.handle

    def write(self, values: NDArray[Any], first: int = 0) -> None:
        """Upload `values`, whole rows of any type, from row `first` on."""
        rows = np.ascontiguousarray(values).reshape(-1).view(np.uint32).reshape(-1, 4)
        begin = 0
        while begin < len(rows):
            # The rest of a line, all whole lines, and a part of the last one.
            line, column = divmod(first + begin, LINE)
            lines = (len(rows) - begin) // LINE if column == 0 else 0
            count = lines * LINE if lines else min(LINE - column, len(rows) - begin)
            texels = rows[begin : begin + count].reshape(max(lines, 1), -1, 4)
            self._texture.write(texels, row=line, column=column)
            begin += count

    def release(self) -> None:
        """Free the texture."""
        self._texture.release()


class Table(Rows):
    """A row of rows for each of `count` structs."""

    def __init__(self, gpu: Gpu, label: str, struct: type[Struct], count: int) -> None:
        super().__init__(gpu, label, rows_of(struct) * count)
        self._struct, self._count = struct, count

    def read(self) -> NDArray[Any]:
        """All structs, as an array of their dtype."""
        texels = self._texture.read().reshape(-1, 4)[: rows_of(self._struct) * self._count]
        return np.ascontiguousarray(texels).reshape(-1).view(self._struct.dtype)


def rows_of(struct: type[Struct]) -> int:
    """How many rows a struct takes. Raises ValueError where they are no whole ones."""
    count, rest = divmod(struct.dtype.itemsize, _ROW_BYTES)
    if rest:
        raise ValueError(f"{struct.__name__} is no whole number of rows: pad it")
    return count


def rows(name: str) -> Slot:
    """The slot of `Rows`: `row_of_NAME(index)` is one as vec4u."""
    return _slot(name, _reader(name, f"row_of_{name}"))


def table(name: str, struct: type[Struct]) -> Slot:
    """The slot of a `Table`: `row_of_NAME(index)` is one of its structs."""
    count, texel = rows_of(struct), f"texel_of_{name}"
    reads = "".join(f"    let r{k} = {texel}({count}u * index + {k}u);\n" for k in range(count))
    values = ", ".join(
        _value(field, struct.dtype.fields[key][1])  # type: ignore[index]
        for key, field in struct.fields.items()
    )
    text = (
        f"{_reader(name, texel)}"
        f"fn row_of_{name}(index: u32) -> {struct.__name__} {{\n"
        f"{reads}    return {struct.__name__}({values});\n}}\n"
    )
    return replace(_slot(name, text), struct=struct)


def _slot(name: str, functions: str) -> Slot:
    slot = texture(name, "2d", "uint")
    return replace(slot, declaration=f"{slot.declaration}\n{functions}")


def _reader(name: str, function: str) -> str:
    """WGSL of a function that reads a row."""
    place = f"vec2u(index % {LINE}u, index / {LINE}u)"
    return f"fn {function}(index: u32) -> vec4u {{ return textureLoad({name}, {place}, 0); }}\n"


def _value(field: Field, offset: int) -> str:
    """WGSL of a field at an offset in bytes, from the rows r0, r1 .. of its struct."""
    row, column = divmod(offset, _ROW_BYTES)
    # Matrices lie in rows of their own, one for each column.
    if len(field.shape) == 2:
        columns = ", ".join(f"bitcast<vec4f>(r{row + k})" for k in range(field.shape[0]))
        return f"{field.wgsl}({columns})"
    kind = _KINDS[field.dtype(0).dtype.kind]
    count = field.shape[0] if field.shape else 1
    words = f"r{row}." + "xyzw"[column // 4 : column // 4 + count]
    return f"bitcast<{kind if count == 1 else f'vec{count}<{kind}>'}>({words})"
