"""Shortcuts through wgpu-py: C types and C structs that are cached, not created every time.

cffi compiles every C type that wgpu-py names when it is first used, and writes all 450 typedefs of
the header before each: about two seconds of a program's start. Only those named in it are needed.
"""

from __future__ import annotations

import re
from functools import lru_cache
from typing import Any

_MOST_LABELS, _LONGEST_LABEL = 256, 64


def declare_only_what_is_named(ffi: Any) -> bool:
    """Make `ffi` (a cffi.FFI) quick at types; whether it could be: cffi's insides may change."""
    parser: Any = getattr(ffi, "_parser", None)
    parse: Any = getattr(parser, "_parse", None)
    if parse is None or not isinstance(getattr(parser, "_declarations", None), dict):
        return False
    if getattr(parse, "is_quick", False):
        return True

    def quick(source: str) -> Any:
        everything = parser._declarations
        named = set(re.findall(r"\w+", source))
        parser._declarations = {
            key: value for key, value in everything.items() if key.rpartition(" ")[2] in named
        }
        try:
            return parse(source)
        finally:
            parser._declarations = everything

    parser._parse = quick
    parser._parse.is_quick = True
    return True


def keep_attachments(encoder: Any) -> bool:
    """Make `encoder` (wgpu-py's class) keep the C structs of what render passes draw into.

    They are the same in every frame, and to make them takes longer than to begin a pass. Returns
    whether it could be: the two methods are wgpu-py's own affair.
    """
    names = ("_create_render_pass_color_attachment", "_create_render_pass_stencil_attachment")
    made = [getattr(encoder, name, None) for name in names]
    if not all(callable(method) for method in made):
        return False
    for name, method in zip(names, made, strict=True):
        if not getattr(method, "is_quick", False):
            setattr(encoder, name, _keeping(method))
    return True


def _keeping(method: Any) -> Any:
    place = f"_kept_by{method.__name__}"

    def quick(self: Any, attachment: dict[str, Any]) -> Any:
        # Structs are kept by the view that they name, and go when it goes.
        held: dict[str, Any] | None = getattr(attachment.get("view"), "__dict__", None)
        if held is None:
            return method(self, attachment)
        kept: dict[Any, Any] = held.setdefault(place, {})
        key = tuple((k, v) for k, v in attachment.items() if k != "view")
        try:
            found = kept.get(key)
        except TypeError:  # what cannot be compared is recreated
            return method(self, attachment)
        if found is None:
            found = kept[key] = method(self, attachment)
        return found

    quick.is_quick = True  # type: ignore[attr-defined]
    return quick


def keep_labels(api: Any) -> bool:
    """Make `api` (the module in which wgpu-py calls the device) keep the C strings of labels.

    Each pass of each frame has one. Returns whether it could be.
    """
    convert: Any = getattr(api, "to_c_string_view", None)
    if not callable(convert):
        return False
    if not getattr(convert, "is_quick", False):
        short = lru_cache(maxsize=_MOST_LABELS)(convert)

        def quick(string: str) -> Any:
            is_label = isinstance(string, str) and len(string) <= _LONGEST_LABEL
            return (short if is_label else convert)(string)

        quick.is_quick = True  # type: ignore[attr-defined]
        api.to_c_string_view = quick
    return True


_DISPATCH_CALLS = {
    "SetPipeline": ("Encoder", "Pipeline"),
    "SetBindGroup": ("Encoder", "uint32_t", "Group", "size_t", "uint32_t *"),
    "DispatchWorkgroups": ("Encoder", "uint32_t", "uint32_t", "uint32_t"),
}


def dispatch_calls(lib: Any, ffi: Any) -> tuple[Any, ...] | None:
    """The C functions that set a compute pass's pipeline and bind group and dispatch.

    wgpu-py wraps each, to raise what goes wrong in it at once; a pass tells when it ends, too. None
    where the library has other ones.
    """
    found = []
    for name, wanted in _DISPATCH_CALLS.items():
        call = getattr(lib, f"wgpuComputePassEncoder{name}", None)
        try:
            given = [argument.cname for argument in ffi.typeof(call).args]
        except (TypeError, AttributeError):
            return None
        if len(given) != len(wanted) or not all(map(_is_like, given, wanted)):
            return None
        found.append(call)
    return tuple(found)


def _is_like(given: str, wanted: str) -> bool:
    return given == wanted or (wanted.isalpha() and wanted in given and given.endswith("*"))
