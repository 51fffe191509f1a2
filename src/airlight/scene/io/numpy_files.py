"""NumPy's .npy and .npz files.

Headers and directories are believed only where the file's own size bears them out, and before
anything is allocated or unpacked.
"""

from __future__ import annotations

import ast
import math
import re
import warnings as python_warnings
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError, nearest, within_memory
from .files import SMALLER, opened, regular_file

NUMBERS = "fiub"
"""NumPy's kinds of what can be used as numbers."""
MODEST_BYTES = 1 << 28
"""What any file may unpack to."""
MOST_UNPACKED = 512
"""How many times its packed size a larger array may have: emptier ones hold nothing."""

_MAGIC = b"\x93NUMPY"
_LONGEST_HEADER = 1 << 16
_DAMAGED_ZIP = (
    zipfile.BadZipFile,
    zlib.error,
    EOFError,
    RuntimeError,
    NotImplementedError,
    ValueError,
)


def read_npy(path: Path, *, most_values: int | None = None) -> NDArray[Any]:
    """The numbers of an .npy file. Raises SceneError."""
    regular_file(path)
    with opened(path) as stream:
        return _array(stream, path.stat().st_size, NUMBERS, most_values)


class Archive:
    """An open .npz file: `names` of its arrays, which are read one by one."""

    def __init__(self, held: zipfile.ZipFile) -> None:
        self._held = held
        self.names = tuple(n[:-4] for n in held.namelist() if n.endswith(".npy"))

    def array(
        self, name: str, *, kinds: str = NUMBERS, most_values: int | None = None
    ) -> NDArray[Any]:
        """An array of one of NumPy's `kinds`. Raises SceneError where there is none of the name."""
        if name not in self.names:
            raise SceneError(f"has no array '{name}'", remedy=nearest(name, self.names))
        # The directory's sizes are checked before anything is unpacked.
        about = self._held.getinfo(f"{name}.npy")
        if about.file_size > max(MODEST_BYTES, MOST_UNPACKED * about.compress_size):
            raise SceneError(
                f"its array '{name}' claims {about.file_size:,} bytes in {about.compress_size:,} "
                "packed ones, too many to be true",
                remedy="Write it with numpy.savez, not packed.",
            )
        with self._held.open(about) as stream:
            return _array(stream, about.file_size, kinds, most_values)


@contextmanager
def opened_npz(path: Path) -> Iterator[Archive]:
    """An .npz file to read arrays from. Raises SceneError for one that is damaged."""
    with opened(path) as stream:
        try:
            with zipfile.ZipFile(stream) as held:
                yield Archive(held)
        except _DAMAGED_ZIP as error:
            raise SceneError(
                f"is not a readable .npz: {error}", remedy="Write it with numpy.savez."
            ) from error


def _array(stream: IO[bytes], size_bytes: int, kinds: str, most_values: int | None) -> NDArray[Any]:
    """The array of an .npy stream of `size_bytes`."""
    # What the head says that it holds.
    shape, is_fortran, dtype = _header(stream)
    if dtype.hasobject:
        raise SceneError("holds Python objects, it must hold numbers")
    if dtype.kind not in kinds or not dtype.itemsize:
        raise SceneError(f"holds {dtype} values, it must hold numbers")
    count = math.prod(shape)
    if most_values is not None and count > most_values:
        raise SceneError(
            f"has {count:,} values, at most {most_values:,} can be used", remedy="Downsample it."
        )
    # The values, no more than the file can hold.
    wanted_bytes = count * dtype.itemsize
    if wanted_bytes > size_bytes:
        raise SceneError(f"is cut short: {wanted_bytes:,} bytes of values do not fit in it")
    size = " x ".join(str(n) for n in shape)
    what = f"its array of {size} values ({wanted_bytes:,} bytes)"
    with within_memory(what, remedy=SMALLER, kind=SceneError):
        content = stream.read(wanted_bytes)
    if len(content) != wanted_bytes:
        raise SceneError(f"is cut short: {len(content):,} of {wanted_bytes:,} bytes of values")
    flat = np.frombuffer(content, dtype=dtype)
    return flat.reshape(shape, order="F" if is_fortran else "C")


def _header(stream: IO[bytes]) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    """Shape, whether columns come first, and type, as an .npy file begins.

    NumPy's own reader raises whatever comes to hand for damaged ones.
    """
    damaged = SceneError("is not a NumPy array, or its header is damaged")
    start = stream.read(8)
    if len(start) < 8 or not start.startswith(_MAGIC) or start[6] not in (1, 2, 3):
        raise damaged
    # The version says how many bytes the header's length has.
    length = int.from_bytes(stream.read(2 if start[6] == 1 else 4), "little")
    if length > _LONGEST_HEADER:
        raise damaged
    # Python 2 wrote whole numbers as 10L.
    text = re.sub(r"(?<=\d)L\b", "", stream.read(length).decode("latin-1"))
    try:
        with python_warnings.catch_warnings():
            python_warnings.simplefilter("ignore")  # of Python that is not quite Python
            # The header is a Python literal, of which nothing is run.
            header = ast.literal_eval(text.strip())
        shape, is_fortran, kind = (header[key] for key in ("shape", "fortran_order", "descr"))
        dtype = np.dtype(kind) if isinstance(kind, str) else None
    except (ValueError, SyntaxError, TypeError, LookupError, MemoryError, RecursionError):
        raise damaged from None
    if dtype is None:
        raise SceneError("holds records, it must hold numbers")
    # A shape that no array can have, or whose product overflows.
    is_shape = isinstance(shape, tuple) and len(shape) <= 32
    if not is_shape or not all(type(n) is int and n >= 0 for n in shape):
        raise SceneError(f"has the impossible shape {str(shape)[:80]}")
    if math.prod(n for n in shape if n) >= 1 << 60:
        raise SceneError(f"has the impossible shape {str(shape)[:80]}")
    return shape, bool(is_fortran), dtype
