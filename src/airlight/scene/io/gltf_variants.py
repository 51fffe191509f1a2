"""KHR_materials_variants: looks of a glTF model, each by its name.

Source: Khronos, KHR_materials_variants: a document lists the names; a primitive maps some of them
to materials, and wears its own one in all others.
"""

from __future__ import annotations

from ...errors import SceneError, nearest
from .gltf_json import Item

EXTENSION = "KHR_materials_variants"


def listed_variants(document: Item) -> tuple[str, ...]:
    """The names of a document's variants, in its order."""
    listed = document.at("extensions", EXTENSION).items("variants")
    return tuple(variant.text("name") for variant in listed)


def variant_number(document: Item, name: str) -> int:
    """Which of a document's variants has a name. Raises SceneError that says which there are."""
    names = listed_variants(document)
    if name in names:
        return names.index(name)
    # A file without variants has no names to suggest.
    if not names:
        raise SceneError(f"there is no material variant '{name}': it has none", where=document.file)
    listed = ", ".join(f"'{known}'" for known in names)
    raise SceneError(
        f"there is no material variant '{name}', but {listed}",
        where=document.file,
        remedy=nearest(name, names),
    )


def worn(primitive: Item, variant: int | None) -> Item:
    """What names a primitive's material as `material`: its mapping for a variant, or itself."""
    if variant is None:
        return primitive
    # The first mapping that lists the variant, by its number in the document.
    for mapping in primitive.at("extensions", EXTENSION).items("mappings"):
        if variant in (number.whole() for number in mapping.items("variants")):
            return mapping
    return primitive
