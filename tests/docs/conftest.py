"""What pages and examples show, run small: the same code, fewer pixels, cells and directions."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from airlight import rendering
from airlight.techniques import technique_settings

REPOSITORY = Path(__file__).parents[2]
LARGEST_PX = (48, 27)
LEAST: dict[str, Any] = {
    "resolution": 8,
    "iterations": 4,
    "surfels": 2000,
    "map_resolution": 32,
    "grid": 6,
    "shadow_resolution": 128,
    "lamp_resolution": 32,
    "sky_lights": 8,
    "sky_resolution": 16,
    "ordinates": 8,
    "solver_steps": 8,
    "shaft_steps": 4,
    "march_steps": 16,
}


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """Renderers are made small, whatever they are asked for; the folder that is the current one."""
    whole_init, whole_frame = rendering.Renderer.__init__, rendering.Renderer.frame

    def init(
        self: Any, scene: Any, technique: str = "auto", size: Any = LARGEST_PX, **options: Any
    ) -> None:
        known = {field.name for field in dataclasses.fields(technique_settings(technique))}
        least = {name: value for name, value in LEAST.items() if name in known}
        asked = options.pop("settings", None) or {}
        width, height = size or LARGEST_PX
        size = (min(width, LARGEST_PX[0]), min(height, LARGEST_PX[1]))
        whole_init(self, scene, technique, size, settings={**asked, **least}, **options)

    def frame(self: Any, *, samples: int = 1, **options: Any) -> Any:
        return whole_frame(self, samples=min(samples, 2), **options)

    monkeypatch.setattr(rendering.Renderer, "__init__", init)
    monkeypatch.setattr(rendering.Renderer, "frame", frame)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def model(small: Path) -> Callable[[str], None]:
    """model("my.obj") writes a floor and a wall under that name: a stranger's own model."""

    def write(name: str) -> None:
        lines = ["v -2 0 -2", "v 2 0 -2", "v 2 0 2", "v -2 0 2", "v -2 2 -2", "v 2 2 -2"]
        (small / name).write_text("\n".join([*lines, "f 1 4 3 2", "f 1 2 6 5", ""]))

    return write
