"""The exported lattice read in NumPy against the device's own lookup of the same lattice."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.errors import SettingsError
from airlight.exports.light_field import LightField
from airlight.exports.solved import export_lattice, light_field
from airlight.gpu.memory import Buffer, buffer_of, linear_sampler
from airlight.gpu.slots import sampler, storage, texture
from airlight.lattice.placement import LatticeParams
from airlight.rendering import Renderer
from airlight.scene import Camera, DirectionalLight, Scene, Volume
from airlight.scene.builtin import builtin_scene
from airlight.scene.nearby import Nearby

SMALL = {"resolution": 12, "surfels": 20_000, "sky_lights": 8}
SLOTS = (
    storage("lattices", LatticeParams),
    *(
        texture(f"lattice_{n}", "3d")
        for n in ("red", "green", "blue", "visibility_a", "visibility_b", "walls", "planes")
    ),
    sampler("linear_clamp"),
    storage("points", "vec4f"),
    storage("normals", "vec4f"),
    storage("results", "vec4f", "read_write"),
)
MAIN = """
//! use surface_coordinates
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= arrayLength(&points)) {
        return;
    }
    let p = points[id.x].xyz;
    let n = normals[id.x].xyz;
    let own = lattice_from_world(lattices[0], n);
    var left = 1.0;
    var sum = vec3f(0.0);
    for (var k = 0u; k < arrayLength(&lattices); k++) {
        let share = left * lattice_weight(lattices[k], p);
        let uvw = lattice_coordinates(lattices[k], p, own);
        sum += share * lattice_irradiance(lattices[k], uvw, own);
        left -= share;
    }
    results[id.x] = vec4f(sum, 0.0);
}
"""


@pytest.fixture
def on_device(gpu, commands, kernel, owned):
    """on_device(technique, points, normals) -> irradiance (n, 3) as the lighting pass reads it."""

    def evaluate(used, points, normals):
        rows = np.zeros((2, len(points), 4), np.float32)
        rows[0, :, :3], rows[1, :, :3] = points, normals
        p, n = (owned(buffer_of(gpu, "rows", r)) for r in rows)
        results = owned(Buffer(gpu, "results", rows[0].nbytes))
        kernel(MAIN, SLOTS).dispatch(
            commands,
            (len(points),),
            **used.fields.irradiance.bound,
            **used.kit.blockers.surface_bound,
            linear_clamp=linear_sampler(gpu),
            points=p,
            normals=n,
            results=results,
        )
        commands.submit()
        return results.read().reshape(-1, 4)[:, :3].astype(np.float64)

    return evaluate


def some_points(lattice, count):
    rng = np.random.default_rng(3)
    low = np.array(lattice.origin)
    high = low + lattice.cell * np.array(lattice.count)
    points = rng.uniform(low, high, size=(count, 3)) @ lattice.axes
    normals = rng.normal(size=(count, 3))
    return points, normals / np.linalg.norm(normals, axis=1, keepdims=True)


def scene_of(name):
    """A builtin scene; "turned": the Cornell box, about two axes."""
    if name != "turned":
        return builtin_scene(name)
    scene, c, s = builtin_scene("cornell"), np.cos(0.4), np.sin(0.4)
    matrix = np.eye(4)
    matrix[:3, :3] = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]) @ [
        [1, 0, 0],
        [0, c, s],
        [0, -s, c],
    ]
    placed = tuple(replace(m, world_from_object=matrix @ m.world_from_object) for m in scene.meshes)
    lights = tuple(light.moved(matrix) for light in scene.lights)
    return replace(scene, meshes=placed, lights=lights)


@pytest.mark.parametrize("name", ["cornell", "bleeding"])
def test_numpy_reads_what_stands_beside_an_oblique_surface_as_the_device_does(on_device, name):
    # Floors and walls: few of their cells know a plane, so there are many points.
    with Renderer(builtin_scene(name), "lpv", (16, 16), settings=SMALL) as renderer:
        renderer.frame(read=False)
        field = light_field(renderer, "lpv")
        points, _ = some_points(field.lattices[0], 20_000)
        normals = np.eye(3)[np.arange(len(points)) % 3]
        expected = on_device(renderer.technique, points, normals)
    found = field.irradiance(points, normals)
    without = replace(field, lattices=tuple(replace(c, planes=None) for c in field.lattices))
    is_beside = (
        np.abs(without.irradiance(points, normals) - found).max(axis=1) > 0.01 * found.mean()
    )
    assert is_beside.sum() > 100
    np.testing.assert_allclose(
        found[is_beside], expected[is_beside], atol=0.01 * expected.max(), rtol=0.02
    )


@pytest.mark.parametrize(
    ("name", "technique", "settings"),
    [
        ("cornell", "lpv", {"cascades": 2}),
        ("cornell", "lpv", {"scheme": "paper"}),
        ("cornell", "lpv", {"cascades": 2, "bounds": (-6.0, -2.9, -2.0, 6.0, 2.9, 2.0)}),
        ("haze-box", "lpv-scatter", {}),
        pytest.param("haze-box", "lpv-scatter", {"cascades": 2}, marks=pytest.mark.slow),
        ("turned", "lpv", {"cascades": 2}),
    ],
)
def test_numpy_reads_the_file_as_the_device_reads_its_textures(
    on_device, tmp_path, name, technique, settings
):
    scene = scene_of(name)
    with Renderer(scene, technique, (16, 16), settings={**SMALL, **settings}) as renderer:
        renderer.frame(read=False)
        light_field(renderer, technique).save(tmp_path / "light.npz")
        field = LightField.load(tmp_path / "light.npz")
        points, normals = some_points(field.lattices[-1], 500)
        expected = on_device(renderer.technique, points, normals)
    found = field.irradiance(points, normals)
    assert (field.lattices[0].axes == np.eye(3)).all() == (name != "turned")
    assert expected.max() > 0.0
    if "bounds" in settings:  # lattices that differ along every axis, in shared textures
        coarse, fine = (np.array(lattice.count) for lattice in reversed(field.lattices))
        assert (coarse != fine)[1:].all()
    for lattice in field.lattices:
        assert lattice.walls.shape[2::-1] == lattice.openness.shape[2::-1] == lattice.count
    air = field.lattices[-1].air
    assert (air is not None and air[..., 0].max() > 0.0) == (technique == "lpv-scatter")
    # Half floats, and texture filtering with 8 bits of fraction.
    np.testing.assert_allclose(found, expected, atol=0.01 * expected.max(), rtol=0.02)


def test_volumes_come_along_where_they_are(gpu, tmp_path):
    bounds = ((1.0, 2.0, 3.0), (2.0, 4.0, 4.0))
    ball = Volume(sigma_t=2.0, density=np.ones((4, 8, 4), np.float32), bounds=bounds)
    scene = Scene(
        lights=(DirectionalLight((0.0, -1.0, 0.0), 3.0),),
        volumes=(ball,),
        camera=Camera((1.0, 2.0, 9.0), (1.0, 2.0, 3.0)),
    )
    small = {"grid": 6, "ordinates": 8, "surfels": 1000}
    field = export_lattice(scene, tmp_path / "light", technique="pop", settings=small)
    assert field.lattices == ()
    (volume,) = field.volumes
    assert volume.radiance.max() > 0.0
    ends = volume.world_from_unit @ np.array([[0.0, 0.0, 0.0, 1.0], [1.0, 1.0, 1.0, 1.0]]).T
    np.testing.assert_allclose(ends[:3].T, bounds, atol=1e-5)
    assert volume.eye == (1.0, 2.0, 9.0)
    assert (tmp_path / "light" / "volume0.npy").exists()


def test_what_lies_far_from_the_origin_is_exported_where_it_is(gpu):
    """The device's own origin is near the camera; files are in the world, settings too."""
    by_m = (5120.0, 0.0, -2560.0)  # by as much as the device's origin: what is solved is the same
    scene = builtin_scene("cornell")
    far = Nearby((-5120.0, -0.0, 2560.0)).of(scene)
    box = np.array((-2.0, 0.5, -2.0, 2.0, 5.0, 2.0))
    fields = [
        export_lattice(one, technique="lpv", settings={**SMALL, "bounds": tuple(bounds.tolist())})
        for one, bounds in ((scene, box), (far, box + np.tile(by_m, 2)))
    ]
    points, normals = some_points(fields[0].lattices[0], 50)
    here = fields[0].irradiance(points, normals)
    there = fields[1].irradiance(points + by_m, normals)
    assert here.max() > 0.0
    np.testing.assert_allclose(there, here, rtol=1e-6, atol=1e-9)
    moved_back = np.subtract(fields[1].lattices[0].origin, by_m)
    np.testing.assert_allclose(moved_back, fields[0].lattices[0].origin, atol=1e-9)


def test_techniques_that_keep_no_light_are_refused():
    for technique in ("direct", "single"):
        with pytest.raises(SettingsError) as caught:
            export_lattice(builtin_scene("cornell"), technique=technique)
        assert str(caught.value) == (
            f"technique '{technique}' keeps no light that could be exported. "
            "Choose from lpv, lpv-march, lpv-sum, lpv-scatter, pop, auto."
        )
