"""Damage to bytes: what a broken disk, a bad exporter or an attacker makes of a file."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable
from random import Random

NUMBERS = (
    0,
    1,
    2,
    3,
    4,
    7,
    8,
    15,
    16,
    127,
    128,
    255,
    256,
    1000,
    4095,
    32767,
    32768,
    65535,
    65536,
    2**24,
    2**28,
    2**30,
    2**31 - 1,
    2**31,
    2**32 - 1,
    2**32,
    2**53,
    2**62,
    2**63 - 1,
    2**63,
    2**64 - 1,
    -1,
    -2,
    -(2**31),
    -(2**63),
)
FLOATS = (
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    1e-30,
    1e30,
    -1e30,
    3.4e38,
    1e38,
    1e308,
    -1e308,
    5e-324,
    float("nan"),
    float("inf"),
    float("-inf"),
)
WRITTEN = (
    b"0",
    b"-1",
    b"1",
    b"2147483648",
    b"4294967296",
    b"9223372036854775808",
    b"-9223372036854775809",
    b"1e39",
    b"1e309",
    b"-1e309",
    b"nan",
    b"inf",
    b"-inf",
    b"-",
    b"",
    b"0x10",
    b"1_000",
    b"1.5",
    b"1" * 400,
    b"9" * 5000,
    b"1e",
    b"--1",
    b"\xd9\xa1",
)
PIECES = (
    b"\0",
    b"\n",
    b"\r\n",
    b"\n\n",
    b"\x1b[31m",
    b"\xff\xfe",
    b"\xef\xbb\xbf",
    b"\xe2\x80\xae",
    b"{",
    b"}",
    b"[",
    b"]",
    b"(",
    b")",
    b"<",
    b">",
    b"&",
    b"'",
    b'"',
    b"\\",
    b"%s",
    b"%n",
    b"$",
    b"\x80",
    b"\xed\xa0\x80",
    b"../",
    b"/dev/zero",
    b" " * 300,
    b"a" * 300,
    b"[" * 3000,
    b'{"a":' * 3000,
    b"<a>" * 3000,
    b"a." * 3000,
)
HEADER_BYTES = 160


def damaged(raw: bytes, random: Random, other: bytes = b"") -> bytes:
    """One to four damages, most of them to the first bytes, where lengths and counts stand.

    `other` is another file to take pieces of.
    """
    for _ in range(random.choice((1, 1, 1, 2, 2, 3, 4))):
        way = random.choice(_WAYS)
        raw = way(raw, random, other)
    return raw


def _at(raw: bytes, random: Random, room: int = 0) -> int:
    last = max(len(raw) - room, 0)
    if random.random() < 0.5:
        last = min(last, HEADER_BYTES)
    return random.randint(0, last)


def _put(raw: bytes, at: int, piece: bytes) -> bytes:
    return raw[:at] + piece + raw[at + len(piece) :]


def _flip(raw: bytes, random: Random, other: bytes) -> bytes:
    at = _at(raw, random, 1)
    return _put(raw, at, bytes([raw[at] ^ 1 << random.randrange(8)])) if raw else raw


def _set(raw: bytes, random: Random, other: bytes) -> bytes:
    return _put(raw, _at(raw, random, 1), bytes([random.choice((0, 1, 127, 128, 254, 255))]))


def _number(raw: bytes, random: Random, other: bytes) -> bytes:
    size, order = random.choice((1, 2, 4, 4, 8)), random.choice(("little", "big"))
    value = random.choice(NUMBERS) % 2 ** (8 * size)
    at = _at(raw, random, size)
    if random.random() < 0.7:
        at -= at % size
    return _put(raw, at, value.to_bytes(size, order))


def _float(raw: bytes, random: Random, other: bytes) -> bytes:
    kind = random.choice("fd")
    value = random.choice(FLOATS)
    try:
        packed = struct.pack(random.choice("<>") + kind, value)
    except OverflowError:
        packed = struct.pack("<d", value)
    at = _at(raw, random, len(packed))
    return _put(raw, at - at % len(packed), packed)


def _cut(raw: bytes, random: Random, other: bytes) -> bytes:
    return raw[: _at(raw, random)]


def _lengthen(raw: bytes, random: Random, other: bytes) -> bytes:
    return raw + random.choice((b"\0", b"\xff", random.choice(PIECES), raw[-64:])) * (
        random.choice((1, 2, 16, 100))
    )


def _remove(raw: bytes, random: Random, other: bytes) -> bytes:
    at = _at(raw, random)
    return raw[:at] + raw[at + random.choice((1, 1, 2, 4, 8, 64)) :]


def _repeat(raw: bytes, random: Random, other: bytes) -> bytes:
    at, size = _at(raw, random), random.choice((1, 4, 16, 64))
    return raw[:at] + raw[at : at + size] * random.choice((2, 3, 50)) + raw[at + size :]


def _insert(raw: bytes, random: Random, other: bytes) -> bytes:
    at = _at(raw, random)
    return raw[:at] + random.choice(PIECES) + raw[at:]


def _splice(raw: bytes, random: Random, other: bytes) -> bytes:
    """From here on another file."""
    if not other:
        return _remove(raw, random, other)
    return raw[: _at(raw, random)] + other[_at(other, random) :]


def _written(raw: bytes, random: Random, other: bytes) -> bytes:
    """Another number where one is written in digits."""
    found = list(re.finditer(rb"-?\d+(\.\d+)?", raw[:4000]))
    if not found:
        return _number(raw, random, other)
    match = random.choice(found)
    return raw[: match.start()] + random.choice(WRITTEN) + raw[match.end() :]


def _word(raw: bytes, random: Random, other: bytes) -> bytes:
    """Another word of the file where one stands, or none."""
    found = list(re.finditer(rb"[A-Za-z_]{2,}", raw[:4000]))
    if not found:
        return _flip(raw, random, other)
    match = random.choice(found)
    new = random.choice((random.choice(found)[0], random.choice(PIECES), b""))
    return raw[: match.start()] + new + raw[match.end() :]


def _line(raw: bytes, random: Random, other: bytes) -> bytes:
    """A line is left out, twice there, or stands elsewhere."""
    lines = raw.split(b"\n")
    taken = lines.pop(random.randrange(len(lines)))
    for _ in range(random.choice((0, 1, 2, 2, 100 if len(taken) < 200 else 3))):
        lines.insert(random.randint(0, len(lines)), taken)
    return b"\n".join(lines)


_WAYS: tuple[Callable[[bytes, Random, bytes], bytes], ...] = (
    _flip,
    _set,
    _number,
    _number,
    _float,
    _cut,
    _lengthen,
    _remove,
    _repeat,
    _insert,
    _splice,
    _written,
    _written,
    _word,
    _line,
)
