"""A full-screen pass as a compute pass: what it returns of a pixel is stored into its targets."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from .interpolants import ENTRY, first_elements
from .raster import Shader
from .slots import Slot, image

WORKGROUP = (8, 8)
_FORMATS = frozenset(
    {f"rgba{bits}{kind}" for bits in (16, 32) for kind in ("uint", "sint", "float")}
    | {f"{channels}32{kind}" for channels in ("r", "rg") for kind in ("uint", "sint", "float")}
    | {"rgba8unorm", "rgba8snorm", "rgba8uint", "rgba8sint"}
)
"""Those that WebGPU stores into on every device."""
_BY_QUADS = re.compile(r"\b(discard|dpdx|dpdy|fwidth|textureSample|textureSampleBias)\b")
"""What only fragments have: neighbours in a quad, and the choice of leaving a pixel as it is."""
_LOCATION = re.compile(r"@location\((\d+)\)\s*(\w+)\s*:")


def is_storable(text: str, formats: Iterable[str], generated: str = "") -> bool:
    """Whether the pass `text` may run as a compute pass that stores into targets of `formats`.

    `generated`: WGSL before it.
    """
    is_alone = not _BY_QUADS.search(text) and _found(text, generated) is not None
    return is_alone and _FORMATS.issuperset(formats)


def stored(
    slots: tuple[Slot, ...],
    firsts: Mapping[str, tuple[str, ...]],
    text: str,
    formats: tuple[str, ...],
    generated: str = "",
) -> Shader:
    """The pass `text` with its targets behind its slots, and a compute shader that calls it."""
    found = _found(text, generated)
    assert found is not None
    whole, members = found
    targets = tuple(image(target_name(k), format) for k, format in enumerate(formats))
    # Of what the pass returns, as much as there are targets.
    lines = [
        f"    textureStore({target_name(k)}, pixel.xy, found{members[k]});"
        for k in range(len(formats))
    ]

    # A thread for each pixel; those beyond the targets leave.
    x, y = WORKGROUP
    entry = [
        f"@compute @workgroup_size({x}, {y}, 1)",
        "fn store(@builtin(global_invocation_id) pixel: vec3u) {",
        f"    if (any(pixel.xy >= textureDimensions({target_name(0)}))) {{ return; }}",
        "    let found = fragment(vec4f(vec2f(pixel.xy) + 0.5, 0.0, 1.0));",
        *lines,
        "}\n",
    ]

    # The pass's own function stays as it is, without a fragment's attributes.
    plain = whole.replace("@fragment ", "").replace("@builtin(position) ", "")
    plain = plain.replace("@location(0) ", "")
    before = first_elements(slots, firsts) + "\n".join(entry)
    return Shader((*slots, *targets), before, text.replace(whole, plain), "store", "compute")


def target_name(index: int) -> str:
    """What a pass calls its target, bound behind its slots."""
    return f"target_{index}"


def _found(text: str, generated: str) -> tuple[str, dict[int, str]] | None:
    """Where the pass begins, and which members of what it returns go to which target."""
    found = ENTRY.search(text)
    if found is None:
        return None

    # One target by itself, or members of a struct by their locations.
    if found[1]:
        return found[0], {0: ""}
    struct = re.search(rf"struct {found[2]} \{{(.*?)\}}", generated + text, re.DOTALL)
    if struct is None:
        return None
    return found[0], {int(k): f".{name}" for k, name in _LOCATION.findall(struct[1])}
