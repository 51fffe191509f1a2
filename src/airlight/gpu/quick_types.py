"""A shortcut through cffi: it declares the C types that wgpu-py names, and no others.

cffi compiles every C type that wgpu-py names when it is first used, and writes all 450 typedefs of
the header before each: 1.4 s of processor time of a program's start. Only those named in it are
needed.
"""

from __future__ import annotations

import re
from typing import Any


def declare_only_what_is_named(ffi: Any) -> bool:
    """Make `ffi` (a cffi.FFI) quick at types; whether it could be: cffi's insides may change."""
    # Where cffi's insides are not as expected, it stays as it is.
    parser: Any = getattr(ffi, "_parser", None)
    parse: Any = getattr(parser, "_parse", None)
    if parse is None or not isinstance(getattr(parser, "_declarations", None), dict):
        return False
    if getattr(parse, "is_quick", False):
        return True

    # cffi declares all it knows each time it parses a type; the names in the source are enough.
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
