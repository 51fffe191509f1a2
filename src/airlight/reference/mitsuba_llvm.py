"""Find a libLLVM that Mitsuba's compiled variants can use."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Mapping
from pathlib import Path

OLDEST_LLVM = 16  # LLVM 15 and older abort the whole process
PREFERRED_LLVM = 19

_FOLDERS = (
    "/usr/lib/*-linux-gnu",
    "/usr/lib/llvm-*/lib",
    "/usr/lib64",
    "/usr/lib64/llvm*/lib*",
    "/usr/lib",
    "/usr/local/lib",
    "/usr/local/opt/llvm*/lib",
    "/opt/homebrew/opt/llvm*/lib",
)


def find_llvm(environment: Mapping[str, str] = os.environ, root: Path = Path("/")) -> Path | None:
    """The libLLVM to use: DRJIT_LIBLLVM_PATH, else version 19 .. 16, else a newer one, or None.

    `root` stands for the file system's root.
    """
    # What the user names is taken or refused, never replaced by another one.
    said = environment.get("DRJIT_LIBLLVM_PATH", "")
    if said:
        path = Path(said)
        version = llvm_version(path)
        return path if path.exists() and (version is None or version >= OLDEST_LLVM) else None
    if sys.platform == "win32":
        return None  # Dr.Jit looks for LLVM-C.dll itself, and has no name to judge it by

    # All libraries whose name tells a version that works.
    found = [
        (version, path)
        for folder in _FOLDERS
        for place in sorted(root.glob(folder.lstrip("/")))
        for path in [*place.glob("libLLVM*.so*"), *place.glob("libLLVM*.dylib")]
        if (version := llvm_version(path)) is not None and version >= OLDEST_LLVM
    ]
    # 19 first, then 18 .. 16, then 20 and on: those came after the Dr.Jit this was tried with.
    found.sort(key=lambda entry: (entry[0] > PREFERRED_LLVM, abs(entry[0] - PREFERRED_LLVM)))
    return found[0][1] if found else None


def llvm_version(path: Path) -> int | None:
    """Major version by a library's (resolved) name; None where the name does not say."""
    for name in (path.name, path.resolve().name):
        match = re.search(r"libLLVM(?:-|\.so\.|\.)(\d+)", name)
        if match:
            return int(match.group(1))
    match = re.search(r"llvm(?:-|@)?(\d+)", str(path.resolve()))
    return int(match.group(1)) if match else None
