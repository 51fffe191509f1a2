"""The statements of a Wavefront MTL file, before they mean a material."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

from ...errors import SceneError
from ..material import Texture
from .files import in_utf8, read_bytes

_OPTION_ARGUMENTS = {
    "-bm": 1,
    "-boost": 1,
    "-texres": 1,
    "-blendu": 1,
    "-blendv": 1,
    "-cc": 1,
    "-clamp": 1,
    "-imfchan": 1,
    "-type": 1,
    "-mm": 2,
}
_VECTOR_OPTIONS = ("-s", "-o", "-t")
_UNREAD_OPTIONS = ("-mm", "-t", "-imfchan")


def read_blocks(path: Path) -> list[Block]:
    """The blocks of a file, one for each name; of two of the same name the first."""
    blocks: dict[str, Block] = {}
    block: Block | None = None
    # A backslash at its end continues a line.
    text = in_utf8(read_bytes(path)).decode("utf-8", "replace").replace("\\\n", " ")
    for number, line in enumerate(text.splitlines(), start=1):
        # A statement ends at a comment; its keyword is in any case of letters.
        keyword, _, rest = line.split("#", 1)[0].strip().replace("\t", " ").partition(" ")
        if keyword.lower() == "newmtl":
            block = Block(rest.strip(), path)
            blocks.setdefault(block.name, block)
        elif keyword and block is not None:
            block.statements[keyword.lower()] = (rest.strip(), number)
    return list(blocks.values())


class Block:
    """The statements of one newmtl: lower-case key -> text and line."""

    def __init__(self, name: str, path: Path) -> None:
        self.name = name
        self.path = path
        self.statements: dict[str, tuple[str, int]] = {}

    def numbers(self, key: str) -> list[float] | None:
        """The numbers of a statement, None where it is absent or spectral."""
        if key not in self.statements:
            return None
        text, line = self.statements[key]
        # Spectra and CIE colours have no numbers that red, green and blue could take.
        words = text.split()
        if words and words[0] in ("spectral", "xyz", "-halo"):
            words = words[1:] if words[0] == "-halo" else []
        try:
            values = [float(word) for word in words]
        except ValueError:
            raise SceneError(
                f"'{key} {text}' is not a list of numbers", where=f"{self.path}, line {line}"
            ) from None
        if not all(math.isfinite(v) for v in values):
            raise SceneError(f"'{key} {text}' is not finite", where=f"{self.path}, line {line}")
        return values or None

    def unread(self, key: str) -> list[str]:
        """What a statement says that nobody reads: spectra, and what is done to an image."""
        words = self.statements.get(key, ("", 0))[0].split()
        if words and words[0] in ("spectral", "xyz"):
            return [f"'{key} {words[0]}'"]
        options = ImageName(" ".join(words)).options if words else {}
        return [f"'{key} {name}'" for name in _UNREAD_OPTIONS if name in options]

    def number(self, key: str) -> float | None:
        """The first of them."""
        values = self.numbers(key)
        return None if values is None else values[0]

    def color(self, key: str) -> tuple[float, float, float] | None:
        """A colour, not negative; one number is grey."""
        values = self.numbers(key)
        if values is None:
            return None
        values = [max(v, 0.0) for v in values]
        return (values[0], values[1], values[2]) if len(values) >= 3 else (values[0],) * 3

    def image(self, *keys: str) -> ImageName | None:
        """The image that the first present of `keys` names."""
        for key in keys:
            name = ImageName(self.statements[key][0]) if key in self.statements else None
            if name and name.file:
                return name
        return None


class ImageName:
    """A texture statement: its options, then a file name that may hold spaces."""

    def __init__(self, text: str) -> None:
        self.options: dict[str, list[str]] = {}
        # Options come first, each with its own number of words.
        words = text.split(" ")
        while words and (words[0] in _OPTION_ARGUMENTS or words[0] in _VECTOR_OPTIONS):
            option = words.pop(0)
            limit = _OPTION_ARGUMENTS.get(option, 3)
            taken: list[str] = []
            # -s, -o and -t take one to three numbers, and the file's name comes last.
            while len(taken) < limit and len(words) > 1:
                if option in _VECTOR_OPTIONS and not is_number(words[0]):
                    break
                taken.append(words.pop(0))
            self.options[option] = taken
        self.file = " ".join(words).strip()

    def vector(self, option: str, default: float) -> tuple[float, float]:
        """The first two numbers of an option."""
        values = [float(v) for v in self.options.get(option, []) if is_number(v)]
        u = values[0] if values else default
        return u, values[1] if len(values) > 1 else default

    def number(self, option: str, default: float) -> float:
        """The number of an option."""
        words = self.options.get(option, [])
        return float(words[0]) if words and is_number(words[0]) else default

    def placed(self, texture: Texture) -> Texture:
        """The texture with this statement's scale, offset and clamp.

        u' = u s + o holds with v upwards; ours runs downwards, so v' = v s + 1 - s - o.
        """
        (su, sv), (ou, ov) = self.vector("-s", 1.0), self.vector("-o", 0.0)
        clamped = self.options.get("-clamp") == ["on"]
        # A texture that is neither scaled nor moved nor clamped is left as it is.
        if (su, sv, ou, ov) == (1.0, 1.0, 0.0, 0.0) and not clamped:
            return texture
        wrap: Any = ("clamp", "clamp") if clamped else ("repeat", "repeat")
        return dataclasses.replace(texture, scale=(su, sv), offset=(ou, 1.0 - sv - ov), wrap=wrap)


def is_number(word: str) -> bool:
    """Whether a word is a finite number."""
    try:
        return math.isfinite(float(word))
    except ValueError:
        return False
