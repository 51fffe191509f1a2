"""Functions that stand in for one another have one signature; nothing calls what nobody defines."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

import airlight
from airlight.gpu.source import LIBRARIES

_NEEDS = re.compile(r"^//! needs (fn .+)$", re.MULTILINE)
_FUNCTION = re.compile(r"\bfn ([\w{}]+)\(([^@()]*)\)(?: -> ([\w<>{}, ]+?))? ?\{", re.DOTALL)
_HOLE = re.compile(r"\{\w+\}")
_COMMENT = re.compile(r"//(?!! use).*")
_BETWEEN_LITERALS = re.compile(r"\"\s*\+?\s*f?\"")


@dataclass(frozen=True)
class Interface:
    """A function by name: its signature, the shaders that call it, the files that define it."""

    name: str
    signature: str
    asked_by: tuple[str, ...]
    given_by: tuple[str, ...]


def needed(text: str) -> dict[str, str]:
    """The functions that a shader leaves to others: signature by name."""
    found = (match[1].strip() for match in _NEEDS.finditer(text))
    return {signature[3 : signature.index("(")]: signature for signature in found}


def defined(text: str) -> Iterator[tuple[str, str]]:
    """(name, signature) of each function in WGSL, or in Python's literals of WGSL.

    A name may have a hole (`{name}_of`), which is filled when the function is generated.
    """
    joined = _BETWEEN_LITERALS.sub("", _COMMENT.sub("", text)).replace("{{", "{")
    for match in _FUNCTION.finditer(joined.replace("\\n", "\n")):
        arguments = " ".join(match[2].split()).rstrip(",")
        result = f" -> {match[3].strip()}" if match[3] else ""
        yield match[1], f"fn {match[1]}({arguments}){result}"


def interfaces(root: Path) -> list[Interface]:
    """All of the package at `root`, by name; files are relative to it."""
    texts = {
        path.relative_to(root).as_posix(): path.read_text(encoding="utf-8")
        for kind in ("*.wgsl", "*.py")
        for path in sorted(root.rglob(kind))
    }
    asked: dict[tuple[str, str], list[str]] = defaultdict(list)
    for file, text in texts.items():
        for name, signature in needed(text).items():
            asked[name, signature].append(file)
    shapes = {file: dict(defined(text)) for file, text in texts.items() if "fn " in text}
    return [
        Interface(
            name,
            signature,
            tuple(files),
            tuple(file for file in shapes if _gives(shapes[file], texts[file], name, signature)),
        )
        for (name, signature), files in sorted(asked.items())
    ]


def _gives(shapes: dict[str, str], text: str, name: str, signature: str) -> bool:
    """Whether a file defines the function, or hands its name to a generator of functions."""
    if shapes.get(name) == signature or ("{name}" in shapes and f'"{name}"' in text):
        return True
    return any(
        re.fullmatch(
            _HOLE.sub(r"\\w+", re.escape(shape).replace(r"\{", "{").replace(r"\}", "}")), signature
        )
        for own, shape in shapes.items()
        if _HOLE.search(own) and own != "{name}"
    )


ROOT = Path(airlight.__file__).parent
HOMES = [folder.relative_to(ROOT).as_posix() for folder in LIBRARIES]
SHADERS = {path.relative_to(ROOT).as_posix(): path for path in sorted(ROOT.rglob("*.wgsl"))}
MODULES = {path.relative_to(ROOT).as_posix(): path for path in sorted(ROOT.rglob("*.py"))}
ALL = interfaces(ROOT)
_WORDS = (
    "abs acos all any array arrayLength asin atan atan2 atomic atomicAdd "
    "atomicCompareExchangeWeak atomicExchange atomicLoad atomicMax atomicMin atomicOr "
    "atomicStore binding bitcast bool builtin ceil "
    "clamp cos countOneBits countTrailingZeros cross determinant distance dot dpdx dpdy exp "
    "exp2 extractBits f32 firstLeadingBit firstTrailingBit floor fma fn for fract group i32 "
    "if insertBits interpolate inverseSqrt length location log log2 loop mat2x2f mat2x3f "
    "mat3x3f mat3x4f mat4x3f mat4x4f max min mix normalize pack2x16float pack2x16snorm "
    "pack2x16unorm pack4x8snorm pack4x8unorm pow reflect return reverseBits round saturate "
    "select sign sin smoothstep sqrt step storageBarrier subgroupShuffleDown "
    "subgroupShuffleUp switch tan tanh textureDimensions textureGather textureLoad "
    "textureNumLayers textureSample textureSampleCompare textureSampleCompareLevel "
    "textureSampleGrad textureSampleLevel textureStore transpose trunc u32 u64 "
    "unpack2x16float unpack2x16snorm unpack2x16unorm unpack4x8snorm unpack4x8unorm var vec2f "
    "vec2i vec2u vec3f vec3i vec3u vec4f vec4i vec4u while workgroupBarrier workgroup_size "
)
BUILT_IN = frozenset(_WORDS.split())


def used_by(name: str, seen: set[str]) -> set[str]:
    """A shader and all that it uses."""
    if name not in seen:
        seen.add(name)
        for library in re.findall(r"^//! use (\w+)", SHADERS[name].read_text(), re.MULTILINE):
            (found,) = (f for f in SHADERS if f in {f"{home}/{library}.wgsl" for home in HOMES})
            used_by(found, seen)
    return seen


def lacking(name: str) -> set[str]:
    """Functions that a shader calls and neither it nor what it uses defines or says it needs.

    `first_SLOT` and `row_of_SLOT` are generated (gpu.interpolants, gpu.rows); types begin with a
    capital.
    """
    own = re.sub(r"//.*", "", SHADERS[name].read_text())
    calls = {
        c for c in re.findall(r"\b([a-z]\w*)\s*\(", own) if not c.startswith(("first_", "row_of_"))
    }
    for text in (SHADERS[other].read_text() for other in used_by(name, set())):
        calls -= set(re.findall(r"\bfn (\w+)", re.sub(r"//(?!! needs).*", "", text)))
    return calls - BUILT_IN


@pytest.mark.parametrize("interface", ALL, ids=lambda i: i.name)
def test_every_interface_has_an_implementation(interface):
    assert interface.given_by, f"nobody defines {interface.signature}"


def test_implementations_have_the_signature_that_is_asked_for():
    asked = {i.name: {j.signature for j in ALL if j.name == i.name} for i in ALL}
    wrong = [
        f"{name}: {own}, asked for is {' or '.join(sorted(asked[function]))}"
        for name, path in {**SHADERS, **MODULES}.items()
        for function, own in defined(path.read_text())
        if function in asked and own not in asked[function]
    ]
    assert not wrong, "\n".join(wrong)


def test_shaders_say_what_they_leave_to_others():
    broken = {n: found for n in SHADERS if (found := lacking(n))}
    assert not broken, "\n".join(f"{n}: //! needs fn {sorted(f)}" for n, f in broken.items())


def test_the_rules_catch_what_they_forbid():
    text = (
        "//! needs fn a(x: f32) -> vec3f\nfn b(\n    x: f32, y: u32,\n) -> f32 { return a(x).x; }"
    )
    assert needed(text) == {"a": "fn a(x: f32) -> vec3f"}
    assert list(defined(text)) == [("b", "fn b(x: f32, y: u32) -> f32")]
