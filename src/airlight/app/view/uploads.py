"""Files that a page sends, in pieces: kept in a folder that goes with the viewer.

They come from elsewhere, so they may name no file of this machine outside of that folder.
"""

from __future__ import annotations

import base64
import binascii
import tempfile
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from ...scene.io.files import confined_to

MOST_BYTES = 256 << 20
_LONGEST_NAME = 120


class Uploads:
    """`take` pieces in their order; a whole file is `opened` by its path."""

    def __init__(self, opened: Callable[[str], None]) -> None:
        self._opened = opened
        self._folder: Path | None = None
        self._while_open = ExitStack()
        self._name, self._parts = "", 0
        self._pieces: list[bytes] = []

    def take(self, message: Mapping[str, Any]) -> None:
        """A piece; one that does not follow the last, or makes too large a file, ends the file."""
        # A piece says which file it belongs to and where it stands; what does not is dropped.
        name, part, parts = (message.get(key) for key in ("name", "part", "parts"))
        piece = _decoded(message.get("data"))
        is_number = all(isinstance(v, int) and not isinstance(v, bool) for v in (part, parts))
        if not isinstance(name, str) or not is_number or piece is None:
            self._pieces = []
            return
        # The first piece begins another file.
        if part == 0:
            self._name, self._parts, self._pieces = name, int(parts or 0), []
        # Pieces come in order, and no larger than a scene may be.
        follows = part == len(self._pieces) and (name, parts) == (self._name, self._parts)
        if not follows or sum(map(len, self._pieces)) + len(piece) > MOST_BYTES:
            self._pieces = []
            return
        self._pieces.append(piece)
        # The last piece opens the file.
        if len(self._pieces) == self._parts:
            data, self._pieces = b"".join(self._pieces), []
            self._opened(str(self._kept(data)))

    def close(self) -> None:
        """The files go."""
        self._while_open.close()
        self._folder = None

    def _kept(self, data: bytes) -> Path:
        # The folder goes when the viewer does.
        if self._folder is None:
            made = tempfile.TemporaryDirectory(prefix="airlight-")
            self._folder = Path(self._while_open.enter_context(made))
            self._while_open.enter_context(confined_to(self._folder))
        # The name alone: no page says where a file goes.
        plain = Path(self._name.replace("\\", "/")).name[-_LONGEST_NAME:]
        safe = "".join(c if c.isalnum() or c in "-_." else "-" for c in plain).lstrip(".") or "file"
        path = self._folder / safe
        path.write_bytes(data)
        return path


def _decoded(data: Any) -> bytes | None:
    try:
        return base64.b64decode(data, validate=True) if isinstance(data, str) else None
    except (binascii.Error, ValueError):
        return None
