"""From a scene to an image: the same bits each run, refusals, animation, closed rooms."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest

from airlight.errors import DeviceError, SceneError, SettingsError
from airlight.rendering import Renderer, render
from airlight.scene import (
    Camera,
    DirectionalLight,
    Environment,
    Material,
    Mesh,
    PointLight,
    Scene,
    shapes,
)
from airlight.scene.image import checked_size
from airlight.scene.io import load

SIZE = (64, 48)
DIRECT = {
    "resolution": 16,
    "shadow_resolution": 256,
    "lamp_resolution": 64,
    "sky_lights": 16,
    "sky_resolution": 16,
    "surfels": 20_000,
}
LPV = {**DIRECT, "map_resolution": 64, "iterations": 16}
CAMERA = Camera(position=(0.0, 1.5, 5.0), target=(0.0, 1.0, 0.0), fov_y_deg=60.0)
WHITE = Material(base_color=(0.8, 0.8, 0.8), specular=0.0)
RED = Material(base_color=(0.8, 0.1, 0.1), specular=0.0)
SUN = DirectionalLight((0.8, -1.0, -0.1), (10.0, 10.0, 10.0))


@pytest.fixture(scope="module")
def corner(square):
    """A white floor that meets a red wall, in the sun."""
    return Scene(
        meshes=(
            square((0, 0, 0), (2, 0, 0), (0, 0, -2), WHITE),
            square((2, 2, 0), (0, 0, 2), (0, 2, 0), RED),
        ),
        lights=(SUN,),
        camera=CAMERA,
    )


@pytest.fixture(scope="module")
def lit(gpu, corner):
    """The corner by `lpv`."""
    return render(corner, "lpv", SIZE, settings=LPV, samples=1)


def test_the_same_bits_each_run(gpu, corner, lit):
    again = render(corner, "lpv", SIZE, settings=LPV, samples=1)
    assert again.radiance.tobytes() == lit.radiance.tobytes()
    for name in lit.layers:
        assert again.layers[name].tobytes() == lit.layers[name].tobytes(), name


def test_layers_add_up_to_the_image(lit):
    assert set(lit.layers) == {"direct", "indirect", "albedo", "normal", "depth"}
    summed = lit.layers["direct"] + lit.layers["indirect"]
    np.testing.assert_array_equal(lit.radiance, summed)
    assert lit.radiance.shape == (48, 64, 3)
    assert all(layer.dtype == np.float32 for layer in lit.layers.values())
    assert np.isfinite(lit.radiance).all()
    assert lit.radiance.min() >= 0.0


def test_depth_is_metres_along_the_ray(lit, camera_rays):
    rays = camera_rays(CAMERA, SIZE)
    with np.errstate(divide="ignore"):
        to_floor = np.where(rays[..., 1] < 0, -1.5 / rays[..., 1], np.inf)
        to_wall = np.where(rays[..., 0] > 0, 2.0 / rays[..., 0], np.inf)
    distance = np.minimum(to_floor, to_wall)
    points = (
        np.array(CAMERA.position) + rays * np.where(np.isfinite(distance), distance, 0)[..., None]
    )
    on_either = np.isfinite(distance) & (np.abs(points[..., [0, 2]]) < 1.9).all(axis=-1)
    on_either &= points[..., 1] < 3.9
    assert on_either.sum() > 300
    depth = lit.layers["depth"]
    # Drivers may place vertices on 1/256 of a pixel: half of that on either axis is so far.
    off = sum(np.abs(d) for d in np.gradient(np.where(on_either, distance, np.nan))) / 512.0
    off = np.where(np.isfinite(off), off, np.nanmax(off))
    found, truth = depth[on_either], distance[on_either]
    assert (np.abs(found - truth) <= off[on_either] + 1e-5 * truth).all()
    assert np.isinf(depth[0, 0])
    assert not lit.radiance[0, 0].any()


def test_normals_and_albedo_are_the_surfaces(lit):
    normal, albedo = lit.layers["normal"], lit.layers["albedo"]
    floor, wall = normal[..., 1] > 0.5, normal[..., 0] < -0.5
    np.testing.assert_array_equal(floor | wall, np.isfinite(lit.layers["depth"]))
    for mask, direction, color in (
        (floor, (0, 1, 0), WHITE.base_color),
        (wall, (-1, 0, 0), RED.base_color),
    ):
        assert mask.sum() > 200
        np.testing.assert_allclose(normal[mask], np.tile(direction, (mask.sum(), 1)), atol=1e-3)
        np.testing.assert_allclose(albedo[mask], np.tile(color, (mask.sum(), 1)), rtol=1e-3)


def test_the_walls_colour_bleeds_onto_the_floor(gpu, corner):
    # What the red wall adds to a black one's image has the wall's colour: 8 to 1. Measured 9.4:
    # surfaces read two-band light by a rule that is not linear, and the floor's own is in it too.
    black = dataclasses.replace(RED, base_color=(0.0, 0.0, 0.0))
    floor, wall = corner.meshes
    without = dataclasses.replace(corner, meshes=(floor, dataclasses.replace(wall, material=black)))
    settings = {**LPV, "ambient_occlusion": False}
    red, dark = (
        render(scene, "lpv", SIZE, settings=settings, samples=1) for scene in (corner, without)
    )
    on_floor = red.layers["normal"][..., 1] > 0.5
    added = (red.layers["indirect"] - dark.layers["indirect"])[on_floor].mean(axis=0)
    assert added[1] > 0.0
    assert added[0] / added[1] == pytest.approx(8.0, rel=0.2)
    assert added[2] / added[1] == pytest.approx(1.0, rel=1e-3)


def test_a_floor_alone_hardly_lights_itself(gpu, corner):
    # In truth not at all. Two bands spread sideways light downwards; this may only fall.
    scene = dataclasses.replace(corner, meshes=corner.meshes[:1])
    image = render(scene, "lpv", SIZE, settings=LPV, samples=1)
    on_floor = np.isfinite(image.layers["depth"])
    share = image.layers["indirect"][on_floor].mean() / image.layers["direct"][on_floor].mean()
    assert share < 0.18


def test_direct_light_is_the_same_in_both_techniques(gpu, corner, lit):
    direct = render(corner, "direct", SIZE, settings=DIRECT, samples=1)
    np.testing.assert_array_equal(direct.layers["direct"], lit.layers["direct"])
    np.testing.assert_array_equal(direct.radiance, direct.layers["direct"])


def test_more_samples_smooth_edges_and_nothing_else(gpu, corner, lit):
    smooth = render(corner, "lpv", SIZE, settings=LPV, samples=8)
    change = np.abs(smooth.radiance - lit.radiance).max(axis=-1) / lit.radiance.max()
    assert np.median(change) < 0.01
    depth = lit.layers["depth"]
    is_edge = np.isfinite(depth) != np.isfinite(np.roll(depth, 1, axis=1))
    assert change[is_edge].max() > 0.05


@pytest.mark.parametrize("samples", [0, -1, 4097])
def test_impossible_samples_are_refused(corner, samples):
    with pytest.raises(SettingsError) as caught:
        render(corner, size=SIZE, samples=samples)
    expected = f"samples = {samples} is out of range. It goes from 1 to 4096"
    assert str(caught.value) == expected


@pytest.mark.parametrize(
    ("size", "message"),
    [
        ((0, 10), "size 0x10 is impossible. Each side goes from 1 to 16384 pixels"),
        ((10, -1), "size 10x-1 is impossible. Each side goes from 1 to 16384 pixels"),
        ((16385, 10), "size 16385x10 is impossible. Each side goes from 1 to 16384 pixels"),
        ((64, 48.5), "size must be two whole numbers, not (64, 48.5)"),
        ((64,), "size must be two whole numbers, not (64,)"),
        ((64, 48, 3), "size must be two whole numbers, not (64, 48, 3)"),
        ("64x48", "size must be two whole numbers, not '64x48'"),
    ],
)
def test_impossible_sizes_are_refused(size, message):
    with pytest.raises(SettingsError) as caught:
        checked_size(size)
    assert str(caught.value) == message


def test_numpy_sizes_are_sizes():
    assert checked_size(np.array([64, 48])) == (64, 48)


def test_an_unknown_technique_is_refused(gpu, corner):
    before = gpu.allocated_bytes
    with pytest.raises(SettingsError, match=r"^unknown technique 'lpw'\. Did you mean 'lpv'\?$"):
        render(corner, "lpw", SIZE)
    assert gpu.allocated_bytes == before


def test_other_kinds_of_lights_are_refused(gpu, corner):
    with Renderer(corner, "direct", SIZE, settings=DIRECT) as renderer:
        with pytest.raises(SettingsError) as caught:
            renderer.frame(lights=[PointLight((0, 1, 0), (1, 1, 1))])
        assert str(caught.value) == (
            "frame() got lights of other kinds than the scene's. Make a new Renderer"
        )


_MADE = (
    "create_buffer",
    "create_texture",
    "create_bind_group",
    "create_compute_pipeline",
    "create_render_pipeline",
    "create_shader_module",
    "create_sampler",
)


@pytest.mark.parametrize("technique", ["direct", "lpv"])
def test_a_moving_light_changes_the_image_and_allocates_nothing(
    gpu, corner, technique, monkeypatch
):
    made = []

    def counting(name, original):
        def create(self, *args, **named):
            made.append(name)
            return original(self, *args, **named)

        return create

    settings = LPV if technique == "lpv" else DIRECT
    before = gpu.allocated_bytes
    with Renderer(corner, technique, SIZE, settings=settings) as renderer:
        still = renderer.frame()
        renderer.frame(lights=[SUN])
        held = gpu.allocated_bytes
        for name in _MADE:
            cls = type(gpu.device)
            monkeypatch.setattr(cls, name, counting(name, getattr(cls, name)))
        for step in range(3):
            moved = DirectionalLight((0.8, -1.0, 0.2 * step), (10, 10, 10))
            renderer.frame(lights=[moved], read=False)
        assert made == []
        assert gpu.allocated_bytes == held
        after = renderer.frame()
        fresh = render(
            dataclasses.replace(corner, lights=(moved,)),
            technique,
            SIZE,
            settings=settings,
            samples=1,
        )
        assert not np.allclose(after.radiance, still.radiance, rtol=0.05)
        np.testing.assert_array_equal(after.radiance, fresh.radiance)
    assert gpu.allocated_bytes == before


def test_what_moves_is_seen_where_it_is(gpu, corner):
    moved = np.eye(4)
    moved[0, 3] = -1.0
    floor, wall = corner.meshes
    meshes = (floor, dataclasses.replace(wall, world_from_object=moved))
    # The same lattice for both: it would follow the walls that a renderer is made with.
    settings = {**LPV, "bounds": (-3, -1, -3, 3, 5, 3), "follow_walls": False}
    with Renderer(corner, "lpv", SIZE, settings=settings) as r:
        r.frame()
        animated = r.frame(meshes=meshes)
    there = dataclasses.replace(corner, meshes=meshes)
    fresh = render(there, "lpv", SIZE, samples=1, settings=settings)
    np.testing.assert_array_equal(animated.layers["direct"], fresh.layers["direct"])
    np.testing.assert_allclose(
        animated.layers["indirect"], fresh.layers["indirect"], atol=1e-3 * fresh.radiance.max()
    )


def test_another_camera_sees_from_elsewhere(gpu, corner, lit):
    with Renderer(corner, "lpv", SIZE, settings=LPV) as renderer:
        elsewhere = dataclasses.replace(CAMERA, position=(-1.5, 1.0, 2.0))
        image = renderer.frame(camera=elsewhere)
        assert not np.allclose(image.radiance, lit.radiance)
        np.testing.assert_array_equal(renderer.frame(camera=CAMERA).radiance, lit.radiance)


def test_progress_and_stats(gpu, corner):
    seen = []
    image = render(
        corner,
        "lpv",
        SIZE,
        settings=LPV,
        samples=2,
        timed=True,
        progress=lambda stage, share: seen.append((stage, share)),
    )
    assert seen == [("preparing", 0.0), ("render", 0.5), ("render", 1.0)]
    stats = json.loads(json.dumps(image.stats))
    assert stats["device"] == gpu.info.name
    assert stats["adapter_type"] == gpu.info.adapter_type
    assert stats["paths"] == gpu.paths.name
    assert stats["size"] == [64, 48]
    assert stats["triangles"] == 4
    assert stats["iterations"] == 16
    assert len(stats["lattice"]) == 3
    assert 0.0 < stats["python_ms"] <= stats["frame_ms"]
    assert stats["peak_gpu_bytes"] > 1_000_000
    assert {"g-buffer", "lighting", "propagate"} <= set(stats["passes"])


def test_exposure_is_the_cameras_or_from_the_image(gpu, corner, lit):
    assert lit.exposure_stops == 0.0
    metered = dataclasses.replace(corner, camera=dataclasses.replace(CAMERA, exposure_stops=None))
    dark = dataclasses.replace(
        metered, lights=(dataclasses.replace(SUN, irradiance=(0.1, 0.1, 0.1)),)
    )
    stops = [
        render(scene, "direct", SIZE, settings=DIRECT, samples=1).exposure_stops
        for scene in (metered, dark)
    ]
    assert stops[1] - stops[0] == pytest.approx(np.log2(100.0), abs=0.2)


@pytest.fixture(scope="module")
def room(square):
    """room(material): six squares around a cube of 4 m."""

    def walls(material):
        axes = 2.0 * np.eye(3)
        return tuple(
            square(side * axes[k], side * axes[k - 2], axes[k - 1], material)
            for k in range(3)
            for side in (1, -1)
        )

    return walls


@pytest.mark.parametrize("light", ["sun", "sky"])
def test_a_sealed_room_is_dark_inside(gpu, room, light):
    sky = Environment(radiance=(3, 3, 3)) if light == "sky" else None
    lights = (SUN,) if light == "sun" else ()
    # The scene's camera is inside: what closes a body around no camera and no lamp is solid, as
    # one mesh or as six, and only its outside stops the sky.
    inside = Camera((0.3, 0.2, -0.1), (1, 0.2, 0.1), fov_y_deg=100.0)
    scene = Scene(meshes=room(WHITE), lights=lights, environment=sky, camera=inside)
    outside = Camera(position=(-5, 6, 5), target=(0, 0, 0), fov_y_deg=40.0)
    settings = {**LPV, "shadow_resolution": 1024, "sky_resolution": 96}
    with Renderer(scene, "lpv", SIZE, settings=settings) as renderer:
        seen = renderer.frame(camera=outside)
        bright = seen.radiance[np.isfinite(seen.layers["depth"])].mean()
        assert bright > 0.5
        for target in [(1, 0.2, 0.1), (-0.2, 0.1, 1), (0.1, -1, 0.2), (-1, 1, -1)]:
            image = renderer.frame(camera=Camera((0.3, 0.2, -0.1), target, fov_y_deg=100.0))
            assert np.median(image.radiance) < 1e-4 * bright
            # sheets without thickness leak within a texel of the edges where they meet
            assert image.radiance.mean() < 1e-3 * bright


@pytest.mark.parametrize(("reflectance", "within"), [(0.2, 0.1), (0.5, 0.1), (0.8, 0.2)])
def test_a_closed_room_is_a_furnace(gpu, room, reflectance, within):
    # Light that bounces on and on: the walls' mean bounced irradiance is rho / (1 - rho) of the
    # lamp's flux over their area, and their bounced radiance rho / pi of that.
    paint = Material(base_color=(reflectance,) * 3, specular=0.0)
    scene = Scene(meshes=room(paint), lights=(PointLight((0, 0, 0), (10, 10, 10)),))
    settings = {**LPV, "lamp_resolution": 128, "map_resolution": 128, "iterations": 128}
    first = 4.0 * np.pi * 10.0 / 96.0
    with Renderer(scene, "lpv", SIZE, settings=settings) as renderer:
        looks = [(1, 0, 0), (0, 0, 1), (0, -1, 0)]
        frames = [renderer.frame(camera=Camera((0, 0, 0), t, fov_y_deg=90.0)) for t in looks]
    indirect = np.mean([frame.layers["indirect"] for frame in frames])
    truth = first * reflectance / (1.0 - reflectance) * reflectance / np.pi
    assert indirect == pytest.approx(truth, rel=within)
    # the three walls are alike
    means = [frame.layers["indirect"].mean() for frame in frames]
    np.testing.assert_allclose(means, means[0], rtol=0.01)


def test_an_empty_scene_is_black(gpu):
    image = render(Scene(), "lpv", SIZE, settings=LPV, samples=1)
    assert not image.radiance.any()
    assert np.isinf(image.layers["depth"]).all()


def test_a_scene_may_be_named_by_its_file(gpu, tmp_path):
    text = '[[mesh]]\nshape = "quad"\n[environment]\nradiance = 2.0\n'
    (tmp_path / "a.toml").write_text(text)
    settings = {"sky_lights": 8, "surfels": 1000, "resolution": 8}
    by_file = render(tmp_path / "a.toml", "direct", (8, 8), settings=settings, samples=1)
    loaded = load(tmp_path / "a.toml")
    by_value = render(loaded, "direct", (8, 8), settings=settings, samples=1)
    np.testing.assert_array_equal(by_file.radiance, by_value.radiance)
    with pytest.raises(SceneError, match="file not found"):
        render("nowhere.toml")


def test_memory_that_runs_out_is_a_device_error(monkeypatch):
    def full(*_):
        raise MemoryError("Unable to allocate 5.00 GiB for an array with shape (1,) and ...")

    monkeypatch.setattr("airlight.rendering.GpuScene", full)
    with pytest.raises(DeviceError, match=r"no memory is left.*5\.00 GiB"):
        Renderer("builtin:cornell", size=(16, 9))


@pytest.mark.parametrize("technique", ["direct", "lpv"])
@pytest.mark.parametrize("scale", [1e-5, 1e-3, 1e3, 1e5])
def test_the_image_of_a_scene_does_not_depend_on_its_size(gpu, scale, technique):
    images = []
    for size in (1.0, scale):
        box = Mesh(geometry=shapes.box(), world_from_object=np.diag((size, size, size, 1.0)))
        floor = np.diag((6.0 * size, size, 6.0 * size, 1.0))
        floor[1, 3] = -0.5 * size
        scene = Scene(
            meshes=(box, Mesh(geometry=shapes.quad(), world_from_object=floor)),
            lights=(DirectionalLight(direction=(-1, -2, -1), irradiance=(3, 3, 3)),),
            environment=Environment(radiance=(1, 1, 2)),
            camera=Camera(position=tuple(size * v for v in (1.2, 0.9, 2.0)), target=(0, 0, 0)),
        )
        settings = DIRECT if technique == "direct" else {**LPV, "resolution": 8, "iterations": 8}
        images.append(render(scene, technique, (32, 18), settings=settings, samples=1).radiance)
    # Blue light of the sky reaches the shadow, and what is farthest is the sky itself. The floor
    # is half way between two faces of cells, and which of them closes must not follow from
    # rounding: up to .07 did. Measured: 2e-5 (`direct`), 1.3e-4 (`lpv`).
    off = np.linalg.norm(images[1] - images[0]) / np.linalg.norm(images[0])
    assert off < (1e-4 if technique == "direct" else 1e-3)
    assert images[0][12, 16].max() > 0.1
