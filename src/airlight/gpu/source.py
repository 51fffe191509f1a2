"""WGSL source: files, the shared library, and errors at the line a person wrote.

A line `//! use phase` pulls in `phase.wgsl` once, before the file that uses it, from one of
`LIBRARIES`. Their files hold functions and constants only. The compiler sees one joined text; its
messages are mapped back to file and line.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import wgpu

from ..errors import ShaderError

_PACKAGE = Path(__file__).parents[1]
LIBRARIES = (_PACKAGE / "wgsl", _PACKAGE / "scene" / "lights")
"""Folders of shader libraries: what is shared, and the types of lights beside their values."""
_USE = re.compile(r"^//! use (\w+)\s*$")
_LINE = re.compile(r"wgsl:(\d+):(\d+)")


@dataclass
class Source:
    """Joined WGSL and, per line, where it came from."""

    lines: list[str] = field(default_factory=list)
    origins: list[tuple[str, int]] = field(default_factory=list)
    used: set[str] = field(default_factory=set)

    @property
    def text(self) -> str:
        """What the compiler gets."""
        return "\n".join(self.lines)

    def add(self, text: str, name: str) -> None:
        """Append `text`, first whatever it uses. Raises ShaderError for an unknown library."""
        # Libraries come before the text that uses them, each once.
        own = text.splitlines()
        for number, line in enumerate(own, 1):
            match = _USE.match(line)
            if match:
                self._use(match[1], f"{name}:{number}")

        # Each line with where it came from, for the compiler's messages.
        self.lines += own
        self.origins += [(name, number) for number in range(1, len(own) + 1)]

    def _use(self, library: str, where: str) -> None:
        if library in self.used:
            return

        # It counts as used before its own uses, so that libraries may use each other.
        self.used.add(library)
        folder = next((f for f in LIBRARIES if (f / f"{library}.wgsl").is_file()), None)
        if folder is None:
            raise ShaderError(f"there is no shader library '{library}'", where=where)
        path = folder / f"{library}.wgsl"
        self.add(path.read_text(), f"{folder.name}/{path.name}")

    def mapped(self, message: str) -> str:
        """A compiler message with the real file and line in place of the joined one's."""

        # Numbers of lines in the joined text become those of their own files.
        def origin(match: re.Match[str]) -> str:
            line = int(match[1])
            if not 1 <= line <= len(self.origins):
                return match[0]
            name, number = self.origins[line - 1]
            return f"{name}:{number}:{match[2]}"

        return _LINE.sub(origin, message)


def compile_wgsl(device: Any, source: Source, label: str) -> Any:
    """The shader module. Raises ShaderError naming the real file and line."""
    try:
        return device.create_shader_module(label=label, code=source.text)
    except wgpu.GPUError as error:
        raise ShaderError(source.mapped(str(error)), where=label) from None
