"""What tells scenes, or arrays, apart: between runs by what is in them, within one by identity."""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, is_dataclass
from pathlib import Path
from types import FunctionType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .camera import Camera

_CHUNK_BYTES = 1 << 20
_PLAIN = (str, bool, float, tuple, Camera)  # compared by value
_UNTOLD = ("warnings", "source")  # what no image depends on


def is_same(now: Sequence[Any], before: Sequence[Any]) -> bool:
    """Whether nothing changed; scenes and their parts are compared by identity, they are frozen."""
    return len(now) == len(before) and all(
        a is b or (isinstance(a, _PLAIN) and a == b) for a, b in zip(now, before, strict=True)
    )


def fingerprint(value: Any, *, without: Collection[str] = ()) -> str:
    """32 hexadecimal digits for scenes and whatever they are made of.

    A path counts with its file's name and contents, a function with its module's and its own name.
    `without`: names of dataclasses' fields that do not count, beside those that no image depends
    on. Raises SceneError for a file that cannot be read, TypeError for what has no fixed content.
    """
    return _Content((*_UNTOLD, *without)).digest(value).hex()


def array_digest(*arrays: NDArray[Any] | None) -> bytes:
    """Equal for arrays of the same types, shapes and values; a gigabyte takes about a second."""
    return _digest(_Content().parts(arrays))


def _digest(parts: Iterable[bytes | memoryview]) -> bytes:
    told = hashlib.blake2b(digest_size=16)
    for part in parts:
        told.update(part)
    return told.digest()


@dataclass(frozen=True)
class _Content:
    """Values as bytes, but for the fields `untold`; `known`: digests of what may be met again."""

    untold: tuple[str, ...] = _UNTOLD
    known: dict[int, bytes] = field(default_factory=dict)

    def digest(self, value: Any) -> bytes:
        """Of a value; a mesh that is placed a thousand times is read once."""
        if not (isinstance(value, np.ndarray) or is_dataclass(value)):
            return _digest(self.parts(value))
        found = self.known.get(id(value))
        if found is None:
            found = self.known[id(value)] = _digest(self.parts(value))
        return found

    def parts(self, value: Any) -> Iterator[bytes | memoryview]:
        """Each kind opens with its own mark, and lists say how long they are."""
        # Numbers and text by how Python writes them, arrays by their bytes.
        if value is None or isinstance(value, (bool, int, float, str, np.generic)):
            yield f"{type(value).__name__}:{value!r};".encode()
        elif isinstance(value, np.ndarray):
            yield f"array:{value.dtype.str}{value.shape};".encode()
            yield np.ascontiguousarray(value).reshape(-1).view(np.uint8).data
        # A file counts by what it holds, wherever it lies.
        elif isinstance(value, Path):
            yield f"file:{value.name};".encode()
            yield from _file(value)
        # Keys in one order, whichever they were put in.
        elif isinstance(value, Mapping):
            yield f"map:{len(value)};".encode()
            for key in sorted(value, key=repr):
                yield self.digest(key)
                yield self.digest(value[key])
        elif isinstance(value, (tuple, list)):
            # The length goes before the items, so that no two nestings read alike.
            yield f"list:{len(value)};".encode()
            for item in value:
                yield self.digest(item)
        else:
            yield from self._made(value)

    def _made(self, value: Any) -> Iterator[bytes | memoryview]:
        # A dataclass is its type and its fields, less what does not count.
        if is_dataclass(value) and not isinstance(value, type):
            yield f"{type(value).__qualname__};".encode()
            for one in fields(value):
                if one.name not in self.untold:
                    yield f"{one.name}=".encode()
                    yield self.digest(getattr(value, one.name))
        elif isinstance(value, functools.partial):
            yield from self.parts((value.func, value.args, value.keywords))
        # A function counts by its name: its code belongs to the program, not to the scene.
        elif isinstance(value, FunctionType):
            yield f"function:{value.__module__}.{value.__qualname__};".encode()
        else:
            raise TypeError(f"{type(value).__name__} has no fixed content to tell scenes apart by")


def _file(path: Path) -> Iterator[bytes]:
    from .io.files import opened

    with opened(path) as file:
        while chunk := file.read(_CHUNK_BYTES):
            yield chunk
