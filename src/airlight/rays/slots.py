"""What a pass binds to send rays.

CPU adapters load 32 bytes in one go as 64-bit integers, in half the time of two rows of four words.
"""

from __future__ import annotations

from dataclasses import replace

from ..gpu.slots import Slot, storage

_ROWS = "struct RayRows { first: vec4u, second: vec4u }\n"
_OF_WORDS = (
    _ROWS
    + """alias RayPair = RayRows;
fn ray_rows(pair: RayPair) -> RayRows {
    return pair;
}
fn ray_link(node: u32, slot: u32) -> u32 {
    return ray_nodes[2u * node + 1u].second[slot];
}
"""
)
_OF_WIDE = (
    _ROWS
    + """alias RayPair = vec4<u64>;
fn ray_row(a: u64, b: u64) -> vec4u {
    return vec4u(u32(a), u32(a >> 32u), u32(b), u32(b >> 32u));
}
fn ray_rows(pair: RayPair) -> RayRows {
    return RayRows(ray_row(pair.x, pair.y), ray_row(pair.z, pair.w));
}
fn ray_link(node: u32, slot: u32) -> u32 {
    return u32(ray_nodes[2u * node + 1u][2u + (slot >> 1u)] >> (32u * (slot & 1u)));
}
"""
)


def _pairs(name: str) -> Slot:
    """A buffer of pairs of rows of four words."""
    slot = storage(name, "RayPair")
    return replace(slot, wide=slot.declaration)


def _defining(slot: Slot, words: str, wide: str) -> Slot:
    """The same slot, with functions behind its declaration."""
    return replace(slot, declaration=f"{slot.declaration}\n{words}", wide=f"{slot.wide}\n{wide}")


RAY_SLOTS: tuple[Slot, ...] = (
    _defining(_pairs("ray_nodes"), _OF_WORDS, _OF_WIDE),
    _pairs("ray_triangles"),
    _pairs("ray_instances"),
)
"""What a pass with `//! use rays` binds beside its own; `RayScene.bound` are the values."""
