"""What a glTF file holds that no reader looks at: a warning for each kind, which names it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from .gltf_json import Item

_NEAREST = 9728
_MORPHED = ("POSITION", "NORMAL", "TANGENT")
"""Of a morph target."""


def extensions_held(value: Any) -> Iterator[str]:
    """The names of all extensions in a document, whether it lists them or not."""
    # A stack instead of recursion: documents may be nested deeply.
    pending = [value]
    while pending:
        held = pending.pop()
        if isinstance(held, list):
            pending += held
        elif isinstance(held, dict):
            extensions = held.get("extensions")
            yield from extensions if isinstance(extensions, dict) else ()
            # `extras` belong to the application that wrote them, and are no part of the model.
            pending += [inner for key, inner in held.items() if key != "extras"]


def losses(document: Item) -> list[str]:
    """Warnings of scenes, cameras, animations, filters and morph targets that are not shown."""
    return [f"{document.file}: {text}" for text in _losses(document)]


def _losses(document: Item) -> Iterator[str]:
    # A file of a later version may mean what is not known here.
    least = document.child("asset").text("minVersion")
    if least not in ("", "2.0"):
        yield f"it asks for glTF {least}, and is read as 2.0"
    # Of several, one is shown.
    scenes = document.items("scenes")
    if len(scenes) > 1:
        shown = _named(scenes, document.integer("scene", 0))
        yield f"it has {len(scenes)} scenes: {shown} is shown"
    # Cameras and clips, of which one each is taken.
    hung = [node for node in document.items("nodes") if node.has("camera")]
    if len(hung) > 1:
        yield f"it has {len(hung)} cameras: the first perspective one in the scene is used"
    clips = document.items("animations")
    if len(clips) > 1:
        yield (
            f"it has {len(clips)} animations: {_named(clips, 0)} plays; the key clip of a scene "
            "file's [[mesh]] names another"
        )
    # What images and morph targets have beside what is read.
    if any(s.integer("magFilter", 0) == _NEAREST for s in document.items("samplers")):
        yield "its samplers ask for magFilter NEAREST: images are smoothed between their texels"
    targets = (
        target
        for mesh in document.items("meshes")
        for primitive in mesh.items("primitives")
        for target in primitive.items("targets")
    )
    lost = sorted({name for target in targets for name in target.keys()} - {*_MORPHED})  # noqa: SIM118
    if lost:
        yield f"morph targets of {', '.join(lost)} are left out"


def _named(items: list[Item], k: int) -> str:
    """The `k`-th of them by its name, or its number."""
    item = items[min(k, len(items) - 1)]
    return f"'{item.text('name')}'" if item.text("name") else f"number {k}"
