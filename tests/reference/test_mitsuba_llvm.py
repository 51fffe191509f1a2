"""Which libLLVM is taken: 19 down to 16, then newer; never 15 or older."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from airlight.reference.mitsuba_llvm import find_llvm, llvm_version

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Dr.Jit finds LLVM-C.dll itself")


def library(root: Path, name: str) -> Path:
    path = root / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.touch()
    return path


def test_versions_by_name() -> None:
    assert llvm_version(Path("/usr/lib/x86_64-linux-gnu/libLLVM-15.so.1")) == 15
    assert llvm_version(Path("/usr/lib/x86_64-linux-gnu/libLLVM.so.19.1")) == 19
    assert llvm_version(Path("/usr/lib/llvm-14/lib/libLLVM.so")) == 14
    assert llvm_version(Path("/opt/homebrew/opt/llvm@18/lib/libLLVM.dylib")) == 18
    assert llvm_version(Path("/opt/libLLVM.so")) is None


@pytest.mark.parametrize(
    ("names", "best"),
    [
        (("libLLVM-14.so", "libLLVM-15.so.1"), None),
        (("libLLVM-15.so", "libLLVM-16.so", "libLLVM-18.so"), "libLLVM-18.so"),
        (("libLLVM-18.so", "libLLVM.so.19.1", "libLLVM-21.so"), "libLLVM.so.19.1"),
        (("libLLVM-20.so", "libLLVM-21.so"), "libLLVM-20.so"),
    ],
)
def test_the_best_of_what_is_there(tmp_path: Path, names, best) -> None:
    for name in names:
        library(tmp_path, f"usr/lib/x86_64-linux-gnu/{name}")
    found = find_llvm({}, tmp_path)
    assert (found.name if found else None) == best


def test_the_users_choice_counts_unless_it_would_abort(tmp_path: Path) -> None:
    library(tmp_path, "usr/lib/x86_64-linux-gnu/libLLVM-19.so")
    own, old = library(tmp_path, "own/libLLVM.so"), library(tmp_path, "own/libLLVM-15.so")
    assert find_llvm({"DRJIT_LIBLLVM_PATH": str(own)}, tmp_path) == own
    assert find_llvm({"DRJIT_LIBLLVM_PATH": str(old)}, tmp_path) is None
    assert find_llvm({"DRJIT_LIBLLVM_PATH": str(tmp_path / "no.so")}, tmp_path) is None
