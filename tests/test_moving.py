"""Moving scenes on the device: a frame is the same whatever was drawn before it."""

from __future__ import annotations

import dataclasses
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.rendering import Renderer, render
from airlight.scene import (
    Camera,
    DirectionalLight,
    Environment,
    Geometry,
    Material,
    Mesh,
    Scene,
    Volume,
)
from airlight.scene.animation import Animation, Curve
from airlight.scene.animation.density import MadeDensity, VolumeTrack
from airlight.scene.animation.tracks import CameraTrack, EnvironmentTrack, LightTrack

SIZE = (48, 32)
SURFACES = {
    "resolution": 12,
    "shadow_resolution": 128,
    "sky_lights": 12,
    "sky_resolution": 16,
    "surfels": 4_000,
}
SETTINGS = {
    "direct": SURFACES,
    "lpv": {**SURFACES, "map_resolution": 32, "iterations": 8},
    "lpv-scatter": {**SURFACES, "map_resolution": 32, "iterations": 4},
    "pop": {**SURFACES, "ordinates": 8, "grid": 6, "solver_steps": 6},
    "auto": SURFACES,
}
TIMES = (0.0, 0.7, 1.6)


@dataclasses.dataclass(frozen=True, eq=False)
class Wave:
    """The scene's last mesh, a sheet, in waves that rise with time."""

    end_s: float = 2.0
    moves_meshes = True

    def apply(self, scene, time_s):
        sheet = scene.meshes[-1]
        flat = sheet.geometry.positions.copy()
        flat[:, 1] = 0.8 + 0.3 * time_s * np.sin(3.0 * flat[:, 0])
        made = dataclasses.replace(sheet.geometry, positions=flat, normals=None)
        moved = dataclasses.replace(sheet, geometry=made)
        return dataclasses.replace(scene, meshes=(*scene.meshes[:-1], moved))


def sheet(cells=12):
    x, z = np.meshgrid(np.linspace(-1, 1, cells + 1), np.linspace(-1, 1, cells + 1))
    positions = np.stack([x.ravel(), np.full(x.size, 0.8), z.ravel()], axis=1)
    k = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    n = cells + 1
    triangles = np.concatenate([[k, k + n, k + 1], [k + 1, k + n, k + n + 1]], axis=1).T
    return Geometry(positions.astype(np.float32), triangles.astype(np.uint32))


def drifting(time_s):
    y = np.linspace(0.0, 1.0, 8, dtype=np.float32)[None, :, None]
    ball = np.exp(-20.0 * (y - 0.2 - 0.3 * np.float32(time_s)) ** 2)
    return np.broadcast_to(ball, (6, 8, 6)).astype(np.float32)


def line(a, b):
    return Curve(np.array([0.0, 2.0]), np.array([a, b], float).reshape(2, -1), "linear")


@pytest.fixture(scope="module")
def moving(square):
    """A floor, a waving sheet, drifting smoke, a turning sun and half a sky, a flying camera."""
    sky = np.zeros((16, 32, 3), np.float32)
    sky[:8, :16] = 2.0
    gray = Material(base_color=(0.6, 0.6, 0.6), specular=0.0)
    return Scene(
        meshes=(square((0, 0, 0), (2, 0, 0), (0, 0, -2), gray), Mesh(sheet(), gray)),
        lights=(DirectionalLight((0.3, -1, 0.2), (6, 6, 6)),),
        environment=Environment(map=sky),
        camera=Camera((0, 1.5, 5), (0, 0.7, 0)),
        volumes=(
            Volume(
                (2, 2, 2), density=drifting(0.0), bounds=((-1, 0.9, -1), (1, 2.5, 1)), g=(0.5,) * 3
            ),
        ),
        animation=Animation(
            (
                CameraTrack({"position": line((0, 1.5, 5), (2, 1.5, 4))}),
                LightTrack(0, {"direction": line((0.3, -1, 0.2), (-0.8, -1, 0.2))}),
                EnvironmentTrack({"rotation_deg": line(0, 120)}),
                VolumeTrack(0, MadeDensity(partial(drifting))),
                Wave(),
            )
        ),
    )


def without_air(scene):
    tracks = tuple(t for t in scene.animation.tracks if not isinstance(t, VolumeTrack))
    return dataclasses.replace(scene, volumes=(), animation=Animation(tracks))


def bits(image):
    return {name: layer.tobytes() for name, layer in image.layers.items()}


SLOW = pytest.mark.slow


@pytest.mark.parametrize(
    "technique",
    ["lpv", "auto", *(pytest.param(t, marks=SLOW) for t in ("direct", "lpv-scatter", "pop"))],
)
def test_a_frame_is_the_same_in_any_order(gpu, moving, technique):
    scene = without_air(moving) if technique in ("direct", "lpv") else moving
    frames = {}
    with Renderer(scene, technique, SIZE, settings=SETTINGS[technique]) as renderer:
        for time in (*TIMES, TIMES[1], TIMES[0]):
            image = renderer.frame(time=time, samples=2)
            found = bits(image)
            assert frames.setdefault(time, found) == found, time
    assert len({frame["albedo"] for frame in frames.values()}) == len(TIMES)
    assert len({frame["direct"] for frame in frames.values()}) == len(TIMES)
    with Renderer(scene, technique, SIZE, settings=SETTINGS[technique]) as alone:
        assert bits(alone.frame(time=TIMES[2], samples=2)) == frames[TIMES[2]]


def test_what_deforms_is_seen_lit_and_shadowed_as_if_made_so(gpu, moving):
    scene = without_air(moving)
    box = {"bounds": (-2, -0.5, -2, 2, 2, 2)}
    with Renderer(scene, "lpv", SIZE, settings={**SETTINGS["lpv"], **box}) as renderer:
        renderer.frame(time=0.0)
        animated = renderer.frame(time=1.6)
    still = dataclasses.replace(scene.at(1.6), animation=None)
    fresh = render(still, "lpv", SIZE, settings={**SETTINGS["lpv"], **box}, samples=1)
    for name in ("albedo", "normal", "depth"):
        np.testing.assert_array_equal(animated.layers[name], fresh.layers[name])
    # Blockers stand at other places of the same triangles: indirect light is nearly the same.
    difference = np.abs(animated.radiance - fresh.radiance).mean() / fresh.radiance.mean()
    assert difference < 0.02
    unmoved = render(scene, "lpv", SIZE, settings={**SETTINGS["lpv"], **box}, samples=1)
    assert np.abs(unmoved.radiance - fresh.radiance).mean() / fresh.radiance.mean() > 0.1


@pytest.mark.parametrize("technique", ["pop", pytest.param("lpv-scatter", marks=SLOW)])
def test_changed_smoke_is_the_smoke_that_it_would_be_from_the_start(gpu, moving, technique):
    only_smoke = Animation((moving.animation.tracks[3],))
    scene = dataclasses.replace(moving, animation=only_smoke)
    settings = SETTINGS[technique]
    with Renderer(scene, technique, SIZE, settings=settings) as renderer:
        renderer.frame()
        animated = renderer.frame(time=1.6)
    still = dataclasses.replace(scene.at(1.6), animation=None)
    fresh = render(still, technique, SIZE, settings=settings, samples=1)
    assert bits(animated) == bits(fresh)


def test_moving_things_allocate_nothing(gpu, moving):
    scene = dataclasses.replace(
        moving, animation=Animation((*moving.animation.tracks[1:2], *moving.animation.tracks[3:]))
    )
    with Renderer(scene, "pop", SIZE, settings=SETTINGS["pop"]) as renderer:
        # Rays are laid out when a mesh first reaches into a volume.
        for time in (0.0, 0.1, *TIMES):
            renderer.frame(time=time, read=False)
        held = gpu.allocated_bytes
        for time in (0.3, 1.1, 1.4):
            renderer.frame(time=time, read=False)
        assert gpu.allocated_bytes == held


def test_what_is_given_holds_over_the_time(gpu, moving):
    scene = without_air(moving)
    camera = Camera((3, 2, 3), (0, 0, 0))
    with Renderer(scene, "direct", SIZE, settings=SURFACES) as renderer:
        renderer.frame(time=1.0, camera=camera)
        assert renderer.scene.camera == camera
        assert renderer.scene.lights == scene.at(1.0).lights
        renderer.frame(time=1.0)
        assert renderer.scene.camera.position == scene.at(1.0).camera.position


def test_a_steady_frame_is_not_the_first(gpu, moving):
    with Renderer(without_air(moving), "direct", SIZE, settings=SURFACES) as renderer:
        assert renderer.stats()["first_image_s"] is None
        renderer.frame()
        first = renderer.stats()
        assert first["frame_ms"] is None and first["python_ms"] is None
        assert first["first_image_s"] > 0.0
        for _ in range(300):
            renderer._count(0.0, 1.0, 2.0)
        later = renderer.stats()
        assert (later["frame_ms"], later["python_ms"]) == (2000.0, 1000.0)
        assert later["first_image_s"] == first["first_image_s"]
        assert len(renderer.frame_ms) <= 300


def test_other_triangles_are_refused_and_other_grids_are_drawn(gpu, moving):
    settings = {**SURFACES}
    other = dataclasses.replace(moving.meshes[-1], geometry=sheet(6))
    fewer = moving.meshes[:1]
    with Renderer(moving, "single", SIZE, settings=settings) as renderer:
        with pytest.raises(SceneError) as caught:
            renderer.frame(meshes=(*fewer, other))
        assert str(caught.value) == (
            "a geometry of 169 vertices and 288 triangles became one of 49 and 72, or other "
            "triangles. Make a new Renderer"
        )
        with pytest.raises(SceneError, match="there are 1 meshes where there were 2"):
            renderer.frame(meshes=fewer)
        thin = dataclasses.replace(moving.volumes[0], density=np.zeros((2, 2, 2), np.float32))
        found = renderer.frame(volumes=(thin,)).radiance
    alone_scene = dataclasses.replace(moving, volumes=(thin,))
    alone = render(alone_scene, "single", SIZE, samples=1, settings=settings)
    np.testing.assert_array_equal(found, alone.radiance)


def resident_mb():
    import resource

    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * resource.getpagesize() / 1e6


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="no /proc to ask")
def test_frames_leave_nothing_behind(gpu, moving):
    # A CPU adapter kept 4 MB of every image, as long as shaders branched on uniforms. On the paths
    # of GPUs it keeps 1.8 of each frame here (1.6 where smoke is isotropic), on its own none.
    with Renderer(moving, "pop", SIZE, settings=SETTINGS["pop"]) as renderer:
        for time in np.linspace(0.0, 1.0, 4):
            renderer.frame(time=float(time))
        before = resident_mb()
        for time in np.linspace(0.0, 2.0, 12):
            renderer.frame(time=float(time))
        assert resident_mb() - before < (30.0 if gpu.paths.name == "gpu" else 8.0)
