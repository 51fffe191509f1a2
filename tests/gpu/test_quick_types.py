"""Types are the same as cffi's own, however they are looked up."""

from __future__ import annotations

import weakref
from types import SimpleNamespace

from cffi import FFI

from airlight.gpu.quick_types import (
    declare_only_what_is_named,
    dispatch_calls,
    keep_attachments,
    keep_labels,
)


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


class View:
    """Something that is drawn into."""


class Encoder:
    """Makes structs as wgpu-py's command encoder does."""

    made = 0

    def _create_render_pass_color_attachment(self, attachment):
        Encoder.made += 1
        return {name: value for name, value in attachment.items() if name != "view"}

    _create_render_pass_stencil_attachment = _create_render_pass_color_attachment


def struct(attachment):
    return {name: value for name, value in attachment.items() if name != "view"}


def test_structs_of_render_passes_are_made_once_and_again_where_anything_differs() -> None:
    assert keep_attachments(Encoder)
    assert keep_attachments(Encoder)  # twice is once
    encoder, views = Encoder(), [View(), View()]
    given = [
        {"view": view, "load_op": load, "store_op": "store", "clear_value": (0, 0, 0, alpha)}
        for view in views
        for load in ("load", "clear")
        for alpha in (0, 1)
    ]
    for _ in range(3):
        for one in given:
            assert encoder._create_render_pass_color_attachment(dict(one)) == struct(one)
    assert Encoder.made == len(given)
    other = {**given[0], "clear_value": {"r": 0.0}}  # which has no hash
    assert encoder._create_render_pass_color_attachment(other) == struct(other)
    depth = {"view": views[0], "depth_load_op": "clear", "depth_clear_value": 1.0}
    assert encoder._create_render_pass_stencil_attachment(depth) == struct(depth)


def test_structs_go_with_the_view_that_they_are_of() -> None:
    assert keep_attachments(Encoder)
    view = View()
    Encoder()._create_render_pass_color_attachment({"view": view, "load_op": "load"})
    gone = weakref.ref(view)
    del view
    assert gone() is None


def test_labels_are_made_once_and_code_is_not_kept() -> None:
    asked: list[str | None] = []
    api = SimpleNamespace(to_c_string_view=lambda text: (asked.append(text), text)[1])
    assert keep_labels(api)
    assert keep_labels(api)  # twice is once
    for text in ("frame", "frame", None, None, "x" * 65, "x" * 65):
        assert api.to_c_string_view(text) == text
    assert asked == ["frame", None, None, "x" * 65, "x" * 65]


def test_another_wgpu_is_left_alone() -> None:
    assert not keep_attachments(object)
    assert not keep_labels(object())


def test_functions_of_another_library_are_not_called() -> None:
    ffi = FFI()
    ffi.cdef("int abs(int);")
    other = SimpleNamespace(
        wgpuComputePassEncoderSetPipeline=ffi.dlopen(None).abs,
        wgpuComputePassEncoderSetBindGroup=ffi.dlopen(None).abs,
        wgpuComputePassEncoderDispatchWorkgroups=ffi.dlopen(None).abs,
    )
    assert dispatch_calls(other, ffi) is None
    assert dispatch_calls(SimpleNamespace(), ffi) is None
