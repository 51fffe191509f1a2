"""Types are the same as cffi's own, however they are looked up."""

from __future__ import annotations

from cffi import FFI

from airlight.gpu.quick_types import declare_only_what_is_named


def made() -> FFI:
    ffi = FFI()
    ffi.cdef(
        "typedef struct { int x; double y; } Point; typedef Point *Place;"
        "typedef void (*Callback)(Point const *, uint32_t);"
    )
    return ffi


def test_types_are_as_without_it() -> None:
    slow, quick = made(), made()
    assert declare_only_what_is_named(quick)
    assert declare_only_what_is_named(quick)  # twice is once
    for name in ("Point *", "Place", "Callback", "Place[3]", "uint32_t[]"):
        assert str(quick.typeof(name)) == str(slow.typeof(name))
    assert quick.new("Point *", [3, 0.5]).y == 0.5


def test_another_cffi_is_left_alone() -> None:
    assert not declare_only_what_is_named(object())
