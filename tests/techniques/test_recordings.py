"""What is recorded in a frame is replayed in those after it, and recomputed where air changes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest

from airlight.gpu import recorded
from airlight.rendering import Renderer
from airlight.scene import Scene, Volume
from airlight.scene.animation import Animation
from airlight.scene.image import Image
from airlight.scene.io import load
from airlight.scene.medium import Medium

SIZE = (24, 18)
SETTINGS = {
    "resolution": 8,
    "shadow_resolution": 64,
    "map_resolution": 32,
    "sky_lights": 4,
    "surfels": 2000,
}
POP = {"ordinates": 8, "grid": 6, "solver_steps": 8}
THIN, THICK = (Medium((s,) * 3, (0.9, 0.8, 0.7)) for s in (0.1, 0.6))


def foggy(medium: Medium = THIN) -> Scene:
    return replace(load("builtin:cornell"), medium=medium)


def smoky() -> Scene:
    box = load("builtin:cornell")
    low, high = box.bounds
    puff = Volume(
        (2.0,) * 3,
        density=np.ones((4, 4, 4), np.float32),
        bounds=(tuple(0.6 * low + 0.4 * high), tuple(0.3 * low + 0.7 * high)),
    )
    return replace(box, volumes=(puff,))


def lit(scene: Scene, share: float) -> dict[str, object]:
    """The scene's lights, so many times as bright."""
    return {
        "lights": tuple(
            replace(x, intensity=tuple(share * v for v in x.intensity)) for x in scene.lights
        )
    }


@pytest.fixture
def recordings(monkeypatch: pytest.MonkeyPatch) -> Callable[[], int]:
    """How many recordings were made since it was last asked."""
    made: list[object] = []

    class Counted(recorded.Recording):
        def __init__(self, *given: object) -> None:
            made.append(self)
            super().__init__(*given)  # type: ignore[arg-type]

    def asked() -> int:
        count = len(made)
        made.clear()
        return count

    monkeypatch.setattr(recorded, "Recording", Counted)
    return asked


@pytest.mark.parametrize(
    ("scene", "technique", "settings", "expected"),
    [
        (lambda: load("builtin:cornell"), "lpv", {"cascades": 3}, 3),
        (foggy, "lpv-scatter", {}, 2),  # shadow bounds and the lattice
        (foggy, "lpv-scatter", {"cascades": 2}, 3),
    ],
)
def test_after_the_first_frame_all_is_replayed(
    gpu, recordings, scene, technique, settings, expected
):
    made = scene()
    with Renderer(made, technique, SIZE, settings={**SETTINGS, **settings}) as renderer:
        counts = []
        for share in (1.0, 2.0, 0.5, 1.5):
            renderer.frame(**lit(made, share), read=False)
            counts.append(recordings())
            held = gpu.allocated_bytes if len(counts) > 1 else 0
        assert gpu.allocated_bytes == held
    assert counts == [expected, 0, 0, 0]


@dataclass(frozen=True)
class Thickens:
    """The air of a second, from second to second; what is None stays."""

    air: tuple[Medium | Volume | None, ...]
    end_s: float = 10.0
    moves_meshes: bool = False

    def apply(self, scene: Scene, time_s: float) -> Scene:
        now = self.air[int(time_s)]
        if isinstance(now, Volume):
            return replace(scene, volumes=(now,))
        return replace(scene, medium=now)


def frames(
    scene: Scene,
    technique: str,
    settings: dict[str, object],
    air: tuple[Medium | Volume, ...],
    order: tuple[int, ...],
    counted: Callable[[], int],
) -> tuple[dict[int, Image], list[int]]:
    """The last image in each air of those in this order, and recordings made for each."""
    moving = replace(scene, animation=Animation((Thickens(air),)))
    images, counts = {}, []
    with Renderer(moving, technique, SIZE, settings={**SETTINGS, **settings}) as renderer:
        for which in order:
            images[which] = renderer.frame(time=float(which))
            counts.append(counted())
    return images, counts


def assert_as_fresh(
    images: dict[int, Image], scenes: list[Scene], technique: str, settings: dict[str, object]
) -> None:
    for which, scene in enumerate(scenes):
        with Renderer(scene, technique, SIZE, settings={**SETTINGS, **settings}) as fresh:
            want = fresh.frame()
        for name, layer in want.layers.items():
            np.testing.assert_array_equal(images[which].layers[name], layer, err_msg=name)
    first, second = (images[which].radiance for which in range(2))
    assert np.linalg.norm(first - second) > 0.02 * np.linalg.norm(first)


@pytest.mark.parametrize("occlusion", [True, False])
def test_other_air_is_drawn_by_the_same_recording_as_from_the_start(gpu, recordings, occlusion):
    settings = {"occlusion": occlusion, "iterations": 8}
    images, counts = frames(
        foggy(), "lpv-scatter", settings, (THIN, THICK), (0, 0, 1, 1, 0), recordings
    )
    assert counts == [2, 0, 0, 0, 0]
    assert_as_fresh(images, [foggy(THIN), foggy(THICK)], "lpv-scatter", settings)


@pytest.mark.parametrize(
    ("technique", "settings", "expected"),
    [
        ("auto", {"cascades": 2, **POP}, 5),  # shadow bounds; lattices of surfaces, and of volumes
        ("lpv-scatter", {"occlusion": False, "iterations": 8}, 2),
        ("lpv-scatter", {"iterations": 8}, 2),
    ],
)
def test_smoke_of_other_density_is_drawn_by_the_same_recording(
    gpu, recordings, technique, settings, expected
):
    (one,) = smoky().volumes
    rising = np.linspace(0.0, 3.0, 64, dtype=np.float32).reshape(4, 4, 4)
    smokes = (one, replace(one, density=rising))
    images, counts = frames(smoky(), technique, settings, smokes, (0, 1, 1, 0), recordings)
    assert counts == [expected, 0, 0, 0]
    scenes = [replace(smoky(), volumes=(smoke,)) for smoke in smokes]
    assert_as_fresh(images, scenes, technique, settings)
