"""Parameters as flat interpolants of the triangle of a full-screen pass, on CPU adapters.

A CPU adapter loads a uniform again for every pixel, lane by lane (a vec4 takes about 4 ns); a flat
interpolant it loads once for eight pixels, at next to no cost.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

from .layout import Field, Struct
from .raster import Shader
from .slots import Slot

MOST_WORDS = 64
"""WebGPU interpolates at least 16 vec4s; a device may have room for more."""
ENTRY = re.compile(
    r"@fragment fn fragment\(@builtin\(position\) position: vec4f\) -> (@location\(0\) )?(\w+) \{"
)
"""How a full-screen pass begins that knows its pixel alone: what it returns, and if that is one."""
_KINDS = {"f": "f32", "u": "u32", "i": "i32"}


@dataclass(frozen=True)
class _Part:
    """One interpolated struct: the variable that pixels read, the buffer of the vertices."""

    variable: str
    source: str
    struct: type[Struct]
    left_out: tuple[str, ...] = ()

    @property
    def words(self) -> list[str]:
        """WGSL expressions for each of its numbers as u32, as the vertex shader reads them."""
        return [
            f"bitcast<u32>({self.source}.{name}{component})"
            for name, field in self.struct.fields.items()
            if name not in self.left_out
            for component in _components(field)
        ]

    def built(self, first: int) -> str:
        """WGSL that rebuilds the struct from the interpolants from `first` on; the rest is zero."""
        # Fields follow each other in words of 32 bits, whatever their types; a vertex stage wrote
        # them so.
        values, at = [], first
        for name, field in self.struct.fields.items():
            if name in self.left_out:
                values.append(f"{field.wgsl}()")
                continue
            count = field.size // 4
            kind = _KINDS[field.dtype(0).dtype.kind]
            words = [f"bitcast<{kind}>({_word(at + i)})" for i in range(count)]
            values.append(words[0] if count == 1 else f"{field.wgsl}({', '.join(words)})")
            at += count
        return f"{self.struct.__name__}({', '.join(values)})"


def interpolated(
    slots: tuple[Slot, ...],
    firsts: Mapping[str, tuple[str, ...]],
    text: str,
    most_words: int = MOST_WORDS,
) -> Shader:
    """The pass `text` with its parameters as flat interpolants, as many as fit.

    Uniforms come first, then, in their order, the first elements of the storage buffers and tables
    `firsts`, each with the fields of it that the pass does not read: `first_NAME()` in the pass.
    """
    found = ENTRY.search(text)
    if not found:
        return Shader(slots, first_elements(slots, firsts), text, "fragment")
    # As many parameters as there are interpolants, uniforms before first elements.
    parts: list[_Part] = []
    used, renamed, rest = 0, [], dict(firsts)
    named = {slot.name: slot for slot in slots}
    for slot in (*(s for s in slots if s.is_dynamic), *(named[name] for name in firsts)):
        part = _part(slot, firsts.get(slot.name, ()))

        # One that does not fit is left out; a smaller one after it may fit.
        if used + len(part.words) > most_words:
            continue
        used += len(part.words)
        parts.append(part)
        rest.pop(slot.name, None)
        renamed += [slot.name] if slot.is_dynamic else []
    # Buffers give up their names to the variables that the pass reads from now on.
    bound = tuple(_renamed(slot) if slot.name in renamed else slot for slot in slots)
    generated = _wgsl(parts, found[1] or "", found[2]) + first_elements(slots, rest)
    plain = f"fn fragment(position: vec4f) -> {found[2]} {{"
    return Shader(bound, generated, text.replace(found[0], plain), "interpolated_fragment")


def first_elements(slots: tuple[Slot, ...], names: Mapping[str, tuple[str, ...]]) -> str:
    """WGSL of `first_NAME()` of storage buffers and tables, read from them."""
    # Buffers keep their names; only the struct's name is asked.
    named = {slot.name: (slot.struct.__name__, slot.first) for slot in slots if slot.struct}
    return "".join(
        f"fn first_{name}() -> {named[name][0]} {{ return {named[name][1]}; }}\n" for name in names
    )


def _part(slot: Slot, left_out: tuple[str, ...]) -> _Part:
    assert slot.struct is not None
    if slot.is_dynamic:
        return _Part(slot.name, f"stored_{slot.name}", slot.struct)
    return _Part(f"carried_{slot.name}", slot.first, slot.struct, left_out)


def _renamed(slot: Slot) -> Slot:
    """The buffer under another name: the pass's own is the variable's."""
    return replace(
        slot, declaration=slot.declaration.replace(f" {slot.name}:", f" stored_{slot.name}:")
    )


def _components(field: Field) -> list[str]:
    # Scalars have no components, vectors up to four, matrices four columns.
    if not field.shape:
        return [""]
    if len(field.shape) == 1:
        return [f".{axis}" for axis in "xyzw"[: field.shape[0]]]
    return [f"[{column}].{axis}" for column in range(4) for axis in "xyzw"]


def _word(index: int) -> str:
    return f"in.w{index // 4}.{'xyzw'[index % 4]}"


def _wgsl(parts: list[_Part], attribute: str, returned: str) -> str:
    # Four words to an interpolant.
    words = [word for part in parts for word in part.words]
    words += ["0u"] * (-len(words) % 4)
    groups = [", ".join(words[i : i + 4]) for i in range(0, len(words), 4)]
    members = "".join(
        f"    @location({i}) @interpolate(flat) w{i}: vec4u,\n" for i in range(len(groups))
    )
    # The struct, a private variable for each part, and the accessors of first elements.
    lines = [f"struct Interpolants {{\n    @builtin(position) position: vec4f,\n{members}}}"]
    lines += [f"var<private> {part.variable}: {part.struct.__name__};" for part in parts]
    lines += [
        f"fn first_{part.variable.removeprefix('carried_')}() -> {part.struct.__name__} "
        f"{{ return {part.variable}; }}"
        for part in parts
        if part.variable.startswith("carried_")
    ]
    # The vertex shader reads all words once; the fragment shader rebuilds the parts from them.
    lines += [
        "//! use screen_corner",
        "@vertex fn fullscreen(",
        "    @builtin(vertex_index) index: u32, @builtin(instance_index) stripe: u32,",
        ") -> Interpolants {",
        "    var out: Interpolants;",
        "    out.position = screen_corner(index, stripe);",
        *(f"    out.w{i} = vec4u({group});" for i, group in enumerate(groups)),
        "    return out;\n}",
        f"@fragment fn interpolated_fragment(in: Interpolants) -> {attribute}{returned} {{",
    ]
    first = 0
    for part in parts:
        lines.append(f"    {part.variable} = {part.built(first)};")
        first += len(part.words)
    return "\n".join([*lines, "    return fragment(in.position);\n}\n"])
