"""Finding and reading the images that a mesh file names, and standing in for missing ones."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path, PurePosixPath

import numpy as np

from ...errors import SceneError
from ..material import Texture
from .files import check_named, named_file, regular_file
from .images import read_texture
from .ledger import note_read


def missing_texture(source: str) -> Texture:
    """A checker in magenta and black that nobody takes for the real thing."""
    checker = np.indices((8, 8)).sum(axis=0) % 2
    pixels = np.zeros((8, 8, 4), dtype=np.uint8)
    pixels[..., (0, 2)] = np.where(checker[..., None], 255, 20)
    pixels[..., 3] = 255
    return Texture(pixels=pixels, source=f"stand-in for {source}")


class TextureFiles:
    """The images beside the mesh file `named_by`. Each is read once; trouble goes to `warnings`."""

    def __init__(self, named_by: Path) -> None:
        self.folder = named_by.parent
        self._named_by = named_by
        self.warnings: list[str] = []
        self._read: dict[tuple[str, bool], Texture | None] = {}

    def color(self, name: str, *, is_srgb: bool = True) -> Texture:
        """An image that people see; a magenta checker and a warning where it cannot be read."""
        return self._texture(name, is_srgb, "a magenta checker stands in") or missing_texture(name)

    def data(self, name: str) -> Texture | None:
        """Normals, roughness and the like; None and a warning where it cannot be read."""
        return self._texture(name, False, "the surface goes without")

    def find(self, name: str) -> Path | None:
        """The file called `name`, whatever its case and slashes, or None.

        Names follow the rule of `files.named_file`. Whole paths are often those of other machines:
        the bare name is looked for in this folder and in `textures` as well.
        """
        plain = PurePosixPath(name.strip().strip('"').replace("\\", "/"))
        if not plain.name:
            return None
        # The path as it is written, then its name alone here, then in `textures`.
        tries = [plain, PurePosixPath(plain.name), PurePosixPath("textures", plain.name)]
        found = next((hit for path in tries if (hit := self._found(path))), None)
        # What is not there may be there when the scene is loaded again.
        if found is None:
            with suppress(SceneError):
                note_read(named_file(str(plain), self._named_by, self.folder))
        return found

    def _found(self, name: PurePosixPath) -> Path | None:
        """The file of that name as seen from the folder; none where no scene may name it."""
        try:
            named_file(str(name), self._named_by, self.folder)
            hit = _cased(self.folder, name)
            if hit is None:
                return None
            check_named(hit, str(name), self._named_by, self.folder)
            return regular_file(hit)
        except SceneError:
            return None

    def _texture(self, name: str, is_srgb: bool, consequence: str) -> Texture | None:
        # A name is read once as a colour and once as data, as these decode differently.
        key = (name, is_srgb)
        if key not in self._read:
            path = self.find(name)
            texture: Texture | None = None
            try:
                if path is None:
                    raise SceneError(f"texture '{name}' is missing", where=self._named_by)
                texture = read_texture(path, is_srgb=is_srgb)
            except SceneError as error:
                self.warnings.append(f"{str(error).rstrip('.')}; {consequence}")
            self._read[key] = texture
        return self._read[key]


def _cased(folder: Path, name: PurePosixPath) -> Path | None:
    """folder/name as a file, each part matched without regard to case if need be."""
    try:
        if (folder / name).is_file():
            return folder / name
        # Written on a system that does not tell cases apart: each part by its letters alone.
        here = folder
        for part in name.parts:
            exact = here / part
            if not exact.exists():
                alike = sorted(p for p in here.iterdir() if p.name.lower() == part.lower())
                if not alike:
                    return None
                exact = alike[0]
            here = exact
        return here if here.is_file() else None
    except (OSError, ValueError):  # a name no file system takes
        return None
