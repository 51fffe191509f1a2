"""Hierarchies are read from the cache only where they are whole."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from airlight import env
from airlight.rays import cached
from airlight.rays.hierarchy import Hierarchy

RNG = np.random.default_rng(3)


@pytest.fixture
def boxes(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> tuple[np.ndarray, np.ndarray]:
    monkeypatch.setenv("AIRLIGHT_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(cached, "WORTH_CACHING", 100)
    low = RNG.random((500, 3)).astype(np.float32)
    return low, low + np.float32(0.1)


def files() -> list[Path]:
    return sorted((env.cache_folder() / "hierarchies").glob("*.npz"))


def assert_same(a: Hierarchy, b: Hierarchy) -> None:
    for name in ("order", "children", "axes", "levels"):
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name))


def test_read_again(boxes: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    first = cached.built(*boxes)
    assert len(files()) == 1
    monkeypatch.delattr(cached, "build")
    assert_same(cached.built(*boxes), first)


@pytest.mark.parametrize("name", ["order", "children", "axes", "levels"])
def test_damaged_files_are_built_again(boxes: Any, name: str) -> None:
    first = cached.built(*boxes)
    (path,) = files()
    with np.load(path) as held:
        arrays = dict(held)
    for bad in (arrays[name][:-1], np.zeros_like(arrays[name])):
        np.savez(path, **{**arrays, name: bad})
        if name != "axes" or len(bad) != len(arrays[name]):
            assert_same(cached.built(*boxes), first)
    path.write_bytes(b"PK damaged")
    assert_same(cached.built(*boxes), first)


def test_other_boxes_have_files_of_their_own(boxes: Any) -> None:
    low, high = boxes
    cached.built(low, high)
    cached.built(low, high + np.float32(0.1))
    assert len(files()) == 2


def test_a_folder_that_cannot_be_written(boxes: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    first = cached.built(*boxes)
    monkeypatch.setenv("AIRLIGHT_CACHE", "/dev/null/nothing")
    assert_same(cached.built(*boxes), first)
