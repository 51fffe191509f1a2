"""The bridge against closed forms: radiometry, orientation, layers, and what can go wrong."""

from __future__ import annotations

import dataclasses
import math
import tempfile
from pathlib import Path

import numpy as np
import pytest

from airlight.errors import ReferenceFailure, SettingsError
from airlight.reference import mitsuba, mitsuba_child
from airlight.scene import (
    Camera,
    DirectionalLight,
    Environment,
    Geometry,
    Material,
    Medium,
    Mesh,
    PointLight,
    Scene,
    SpotLight,
    Texture,
    Volume,
)
from airlight.scene.io import load
from airlight.scene.shapes import box

pytestmark = pytest.mark.needs("mitsuba")
needs_llvm = pytest.mark.needs("libLLVM")

BLACK = Material(name="black", base_color=(0, 0, 0), specular=0.0)
LAMBERT = Material(name="lambert", base_color=(0.6, 0.4, 0.2), specular=0.0)


def floor(material: Material, half: float = 2.0, y: float = 0.0, colors=None) -> Mesh:
    """A square facing +Y; u along +X, v along +Z."""
    x = np.array([[-1, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1]], np.float32) * half
    uvs = np.array([[0, 0], [0, 1], [1, 1], [1, 0]], np.float32)
    up = np.tile(np.float32([0, 1, 0]), (4, 1))
    triangles = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
    geometry = Geometry(x + np.float32([0, y, 0]), triangles, normals=up, uvs=uvs, colors=colors)
    return Mesh(geometry, material, name="floor")


def from_above(height: float = 3.0, fov: float = 40.0) -> Camera:
    """Looks straight down: +X to the right, +Z towards the bottom row."""
    return Camera(position=(0, height, 0), target=(0, 0, 0), up=(0, 0, -1), fov_y_deg=fov)


def pixel_centres(camera: Camera, size: tuple[int, int]) -> np.ndarray:
    """Unit view directions (H, W, 3), by our own look-at."""
    eye, target, up = (np.array(v) for v in (camera.position, camera.target, camera.up))
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, up)
    right /= np.linalg.norm(right)
    above = np.cross(right, forward)
    width, height = size
    tan = math.tan(math.radians(camera.fov_y_deg) / 2)
    x = ((np.arange(width) + 0.5) / width * 2 - 1) * tan * width / height
    y = (1 - (np.arange(height) + 0.5) / height * 2) * tan
    rays = forward + x[None, :, None] * right + y[:, None, None] * above
    return rays / np.linalg.norm(rays, axis=-1, keepdims=True)


def floor_points(camera: Camera, size: tuple[int, int]) -> np.ndarray:
    """Where the pixels' centres see the plane y = 0."""
    rays = pixel_centres(camera, size)
    eye = np.array(camera.position)
    return eye - rays * (eye[1] / rays[..., 1:2])


def quick(scene: Scene, size: tuple[int, int] = (16, 12), spp: int = 16, **options):
    return mitsuba.render(scene, size=size, spp=spp, variant="scalar_rgb", **options)


def test_silhouettes_are_pixel_exact() -> None:
    """A glowing triangle seen aslant covers exactly the pixels our own projection says."""
    camera = Camera(position=(1.2, 0.7, 2.0), target=(0.1, 0.3, -1.0), up=(0.2, 1, 0.1))
    corners = np.array([[-1.0, -0.4, -1.5], [1.3, -0.2, -0.5], [0.2, 1.4, -1.0]], np.float32)
    glowing = dataclasses.replace(BLACK, emission=(1, 2, 3))
    triangle = Mesh(Geometry(corners, np.array([[0, 1, 2]], np.uint32)), glowing)
    size = (40, 28)
    image = quick(Scene(meshes=(triangle,), camera=camera), size, 64, max_depth=1).radiance

    rays = pixel_centres(camera, size)
    sides = [
        np.cross(corners[k] - camera.position, corners[k - 2] - camera.position) for k in range(3)
    ]
    depth = np.stack([rays @ (s / np.linalg.norm(s)) for s in sides], axis=-1)
    depth *= np.sign(np.median(depth[np.abs(depth).min(-1) > 0][..., 0]))
    inside = (depth > 0).all(-1) | (depth < 0).all(-1)
    distance = np.abs(depth).min(-1)
    pixel = np.linalg.norm(rays[0, 1] - rays[0, 0])
    clear = distance > pixel
    assert inside[clear].sum() > 100
    np.testing.assert_allclose(image[inside & clear], [[1, 2, 3]] * (inside & clear).sum())
    assert image[~inside & clear].max() == 0.0


@pytest.mark.parametrize(
    "light",
    [
        DirectionalLight((0.6, -0.8, 0.0), (3.0, 2.0, 1.0)),
        PointLight((0.3, 1.5, -0.2), (5.0, 4.0, 3.0)),
        SpotLight((0.2, 1.5, 0.1), (0.1, -1.0, 0.2), (7.0, 6.0, 5.0), inner_deg=12, outer_deg=28),
    ],
)
def test_direct_light_on_a_floor(light) -> None:
    camera, size = from_above(), (32, 32)
    scene = Scene(meshes=(floor(LAMBERT),), lights=(light,), camera=camera)
    image = quick(scene, size, 256, max_depth=2).radiance
    fine = 4  # averaged over the pixel, as the renderer does
    points = floor_points(camera, (fine * size[0], fine * size[1]))
    if isinstance(light, DirectionalLight):
        arriving = 0.8 * np.array(light.irradiance) * np.ones((*points.shape[:2], 1))
    else:
        delta = points - light.position
        distance = np.linalg.norm(delta, axis=-1, keepdims=True)
        cosine = -delta[..., 1:2] / distance
        arriving = np.array(light.intensity) * cosine / distance**2
        if isinstance(light, SpotLight):
            inner, outer = (math.cos(math.radians(a)) for a in (12, 28))
            t = np.clip((delta / distance @ light.direction - outer) / (inner - outer), 0, 1)
            arriving = arriving * (t * t * (3 - 2 * t))[..., None]
    arriving = arriving.reshape(size[1], fine, size[0], fine, -1).mean((1, 3))
    expected = arriving * np.array(LAMBERT.base_color) / math.pi
    np.testing.assert_allclose(image, expected, rtol=0.02, atol=0.015 * expected.max())
    np.testing.assert_allclose(image.mean(), expected.mean(), rtol=2e-3)


def test_environment_orientation_and_rotation() -> None:
    """One bright quadrant, looked up by DESIGN's formula, turned counter-clockwise from above."""
    pixels = np.full((32, 64, 3), 0.1, np.float32)
    pixels[:16, 16:32] = (1, 2, 3)
    size = (24, 16)
    for angle, targets in ((0.0, [(1, 0.3, 0.2)]), (50.0, [(0.1, 0.2, -1), (0.1, 0.3, 1)])):
        environment = Environment(map=pixels, rotation_deg=angle, scale=2.0)
        for target in targets:
            camera = Camera(position=(0, 0, 0), target=target, fov_y_deg=70)
            scene = Scene(environment=environment, camera=camera)
            image = quick(scene, size, 4, max_depth=1).radiance
            x, y, z = np.moveaxis(pixel_centres(camera, size), -1, 0)
            c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
            x, z = c * x - s * z, s * x + c * z  # into the map: the inverse turn
            u = np.arctan2(x, -z) / (2 * math.pi) % 1.0
            v = np.arccos(y) / math.pi
            bright = (u > 0.25) & (u < 0.5) & (v < 0.5)
            border = np.minimum.reduce([abs(u - 0.25), abs(u - 0.5), abs(v - 0.5) / 2, v, 1 - v])
            clear = border > 0.04
            expected = np.where(bright[..., None], [2, 4, 6], 0.2)
            np.testing.assert_allclose(image[clear], expected[clear], rtol=1e-3)


@pytest.mark.parametrize("variant", ["scalar_rgb", pytest.param("auto", marks=needs_llvm)])
def test_hidden_environment_keeps_its_light_and_local_lights(variant: str) -> None:
    local_light = floor(dataclasses.replace(BLACK, emission=(5, 5, 5)), half=0.2, y=0.5)
    meshes = (floor(LAMBERT, half=0.7), local_light)
    camera = from_above()
    seen = Environment(radiance=(0.5, 0.5, 0.5))
    hidden = dataclasses.replace(seen, visible=False)
    size = (16, 16)
    images = [
        mitsuba.render(
            Scene(meshes=meshes, environment=e, camera=camera), size=size, spp=64, variant=variant
        ).radiance
        for e in (seen, hidden)
    ]
    corner, centre = (0, 0), (8, 8)
    np.testing.assert_allclose(images[0][corner], 0.5, rtol=1e-5)
    np.testing.assert_allclose(images[1][corner], 0.0, atol=1e-5)
    np.testing.assert_allclose(images[1][centre], 5.0, rtol=1e-5)
    on_floor = (8, 5)
    np.testing.assert_allclose(images[1][on_floor], images[0][on_floor], rtol=0.2)


def test_furnace_and_its_layers() -> None:
    """A closed box that glows with e and reflects a: e/(1-a) in all, a^n e by each order."""
    a, e = 0.5, 2.0
    room = Mesh(box(), Material(base_color=(a, a, a), specular=0.0, emission=(e, e, e)))
    camera = Camera(position=(0.1, 0.2, 0.3), target=(0, 0, -0.4), fov_y_deg=60)
    names = ("all", "direct", "one_bounce", "indirect", "single_scatter", "transmittance")
    images = mitsuba.render_layers(
        Scene(meshes=(room,), camera=camera), names, size=(8, 8), spp=256, variant="scalar_rgb"
    )
    expected = {
        "all": e / (1 - a),
        "direct": e + a * e,
        "one_bounce": a * a * e,
        "indirect": a * a * e / (1 - a),
        "single_scatter": 0.0,
        "transmittance": 1.0,
    }
    for name, value in expected.items():
        image = images[name]
        noise = math.sqrt(image.layers["variance"].mean() / image.radiance[..., 0].size)
        assert abs(image.radiance.mean() - value) <= 4 * noise + 2e-3 * value, name


def air_scene(**medium) -> Scene:
    camera = Camera(position=(0, 0, 3), target=(0, 0, 0), fov_y_deg=2)
    air = Medium(bounds=((-1, -1, -1), (1, 1, 1)), **medium)
    sun = DirectionalLight((1, 0, 0), (2, 2, 2))
    return Scene(medium=air, lights=(sun,), camera=camera)


@pytest.mark.parametrize("g", [(0.6,) * 3, (0.0, 0.5, -0.5)])
def test_single_scattering_in_a_box_of_air(g) -> None:
    """Seen from the front, lit from the side: a quadrature along the middle ray."""
    sigma_t, albedo = np.array([0.2, 0.5, 1.0]), np.array([0.9, 0.8, 0.7])
    scene = air_scene(sigma_t=tuple(sigma_t), albedo=tuple(albedo), g=g)
    image = quick(scene, (6, 6), 4096, max_depth=2)
    z = (np.arange(400) + 0.5) / 400 * 2.0
    g_ = np.array(g)
    phase = (1 - g_**2) / (4 * math.pi * (1 + g_**2) ** 1.5)  # at right angles
    depth = np.exp(-sigma_t[None] * (z[:, None] + 1.0))
    expected = (albedo * sigma_t * phase * 2.0 * depth).mean(0) * 2.0
    measured = image.radiance.mean((0, 1))
    noise = np.sqrt(image.layers["variance"].mean((0, 1)) / 36)
    assert (np.abs(measured - expected) < 4 * noise + 0.01 * expected).all()


def test_a_density_grid_lies_where_it_should() -> None:
    """Absorbing voxels before a white sky: Beer-Lambert through the trilinear grid."""
    rng = np.random.default_rng(3)
    density = rng.random((3, 4, 5)).astype(np.float32)
    turn = np.eye(4)
    turn[:3, :3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]  # a quarter turn about z: x -> y
    low, high = np.array([-0.5, -0.4, -0.3]), np.array([0.5, 0.4, 0.3])
    volume = Volume(
        sigma_t=(1.0, 2.0, 4.0),
        albedo=(0, 0, 0),
        density=density,
        bounds=(tuple(low), tuple(high)),
        world_from_volume=turn,
    )
    camera = Camera(position=(0, 0, 40), target=(0, 0, 0), fov_y_deg=0.8)
    sky = Environment(radiance=(1, 1, 1))
    size = (8, 8)
    scene = Scene(volumes=(volume,), environment=sky, camera=camera)
    image = quick(scene, size, 2048, max_depth=1)

    from scipy.ndimage import map_coordinates

    rays = pixel_centres(camera, size)
    depth = np.linspace(39.6, 40.4, 400)
    points = np.array(camera.position) + rays[..., None, :] * depth[:, None]
    local = points @ turn[:3, :3]  # the inverse of a rotation, on row vectors
    inside = ((local > low) & (local < high)).all(-1)
    grid = (local - low) / (high - low) * density.shape[::-1] - 0.5
    values = map_coordinates(density, np.moveaxis(grid, -1, 0)[::-1], order=1, mode="nearest")
    tau = (values * inside).sum(-1) * (depth[1] - depth[0])
    expected = np.exp(-tau[..., None] * np.array(volume.sigma_t))
    noise = np.sqrt(image.layers["variance"])
    assert np.ptp(expected) > 0.5
    assert (np.abs(image.radiance - expected) < 6 * noise + 0.01).mean() > 0.97


@pytest.mark.parametrize("sigma_t", [(1.0, 1.0, 1.0), (0.5, 1.0, 2.0)])
def test_a_constant_grid_equals_homogeneous_air(sigma_t) -> None:
    scene = air_scene(sigma_t=sigma_t, albedo=(0.9, 0.9, 0.9), g=(0.4,) * 3)
    bounds = scene.medium.bounds
    ones = np.ones((2, 3, 4), np.float32)
    grid = Volume(sigma_t=sigma_t, albedo=(0.9,) * 3, g=(0.4,) * 3, density=ones, bounds=bounds)
    as_grid = dataclasses.replace(scene, medium=None, volumes=(grid,))
    images = [quick(s, (6, 6), 1024) for s in (scene, as_grid)]
    means = [p.radiance.mean((0, 1)) for p in images]
    noise = np.sqrt(sum(p.layers["variance"].mean((0, 1)) for p in images) / 36)
    assert (np.abs(means[0] - means[1]) < 4 * noise + 1e-3 * means[0]).all()


def test_a_volume_inside_air_adds_its_extinction() -> None:
    air = Medium(sigma_t=(0.3,) * 3, albedo=(0.5,) * 3, bounds=((-1, -1, -1), (1, 1, 1)))
    inner = Volume(
        sigma_t=(1.0,) * 3, albedo=(0.1,) * 3, shape="box", bounds=((-0.5,) * 3, (0.5,) * 3)
    )
    camera = Camera(position=(0, 0, 3), target=(0, 0, 0), fov_y_deg=5)
    scene = Scene(medium=air, volumes=(inner,), environment=Environment(), camera=camera)
    image = quick(scene, (4, 4), 4096, max_depth=1)
    expected = math.exp(-0.3 * 2.0 - 1.0 * 1.0)
    assert abs(image.radiance.mean() - expected) < 0.01


def test_textures_wrap_scale_and_colours_face_the_right_way() -> None:
    pixels = np.zeros((2, 2, 4), np.uint8)
    pixels[..., 3] = 255
    pixels[0, 0, 0], pixels[0, 1, 1], pixels[1, 0, 2] = 255, 255, 255
    sky = Environment(radiance=(1, 1, 1))
    camera = from_above(height=1.0, fov=2 * math.degrees(math.atan(1.0)))
    texture = Texture(pixels, scale=(2.0, 1.0), offset=(0.0, 0.25), wrap=("repeat", "mirror"))
    material = Material(base_color_texture=texture, base_color=(0.5, 1, 1), specular=0.0)
    scene = Scene(meshes=(floor(material, half=1.0),), environment=sky, camera=camera)
    image = quick(scene, (16, 16), 64, max_depth=2).radiance
    # Near texel centres, where filtering does little: u = x + 1, v = (z + 1) / 2 + 1/4, and v is
    # mirrored beyond 1, where it would repeat red and green.
    red, green, blue, black = (0.5, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 0)
    seen = {(0.25, 0.3): red, (0.75, 0.3): green, (0.25, 0.75): blue, (0.75, 0.75): black}
    seen |= {(1.25, 0.3): red, (1.25, 0.75): blue, (0.25, 1.2): blue}
    for (u, v), color in seen.items():
        column, row = int(u / 2 * 16), int((v - 0.25) * 16)
        np.testing.assert_allclose(image[row, column], color, atol=0.3)

    colors = np.ones((4, 4), np.float32)
    colors[:, :3] = [[1, 0, 0], [0, 0, 1], [0, 0, 1], [1, 0, 0]]  # red at -Z, blue at +Z
    painted = floor(dataclasses.replace(LAMBERT, base_color=(0.8,) * 3), half=1.0, colors=colors)
    image = quick(dataclasses.replace(scene, meshes=(painted,)), (8, 8), 64).radiance
    expected = 0.8 * (1 - (np.arange(8) + 0.5) / 8)
    np.testing.assert_allclose(image[..., 0].mean(1), expected, atol=0.02)


def test_alpha_masks_cut_the_surface_and_its_shadow() -> None:
    pixels = np.full((2, 2, 4), 255, np.uint8)
    pixels[:, 0, 3] = 0  # nothing for u < 1/2, that is x < 0
    leaf = Material(
        base_color_texture=Texture(pixels, wrap=("clamp", "clamp")),
        alpha_cutoff=0.5,
        specular=0.0,
        base_color=(0.0, 0.0, 0.0),
    )
    meshes = (floor(leaf, half=1.0, y=1.0), floor(LAMBERT, half=3.0))
    sun = DirectionalLight((0, -1, 0), (math.pi,) * 3)
    camera = Camera(position=(0, 0.5, 0.01), target=(0, 0, 0), up=(0, 0, -1), fov_y_deg=60)
    image = quick(Scene(meshes=meshes, lights=(sun,), camera=camera), (16, 8), 16, max_depth=2)
    np.testing.assert_allclose(image.radiance[:, 1], [LAMBERT.base_color] * 8, rtol=1e-3)
    assert image.radiance[:, -2].max() == 0.0


def test_normal_maps_tilt_the_normal() -> None:
    """Tangent-space +X is the way u grows, +Y the way v falls (up in the image)."""
    camera = from_above()
    for axis, light in ((0, (0.6, 0.8, 0.0)), (1, (0.0, 0.8, -0.6))):
        n = np.array([0.0, 0.0, 0.8])
        n[axis] = 0.6
        pixel = np.append(np.round((n * 0.5 + 0.5) * 255), 255).astype(np.uint8)
        bumped = dataclasses.replace(
            LAMBERT, normal_texture=Texture(np.tile(pixel, (2, 2, 1)), is_srgb=False)
        )
        sun = DirectionalLight(tuple(-c for c in light), (math.pi,) * 3)
        scene = Scene(meshes=(floor(bumped),), lights=(sun,), camera=camera)
        image = quick(scene, (4, 4), 4, max_depth=2).radiance
        np.testing.assert_allclose(image[1, 1], LAMBERT.base_color, rtol=0.02)


def gltf_reflection(base, roughness, metallic, specular, n_l, n_v, n_h, v_h) -> np.ndarray:
    """glTF 2.0, appendix B, written out once more."""
    base = np.array(base)
    f0 = 0.04 * specular * (1 - metallic) + base * metallic
    f90 = min(1.0, 50 * f0.max())
    fresnel = f0 + (f90 - f0) * (1 - v_h) ** 5
    a2 = roughness**4
    d = a2 / (math.pi * (n_h**2 * (a2 - 1) + 1) ** 2)
    v = 0.5 / (n_l * math.sqrt(n_v**2 * (1 - a2) + a2) + n_v * math.sqrt(n_l**2 * (1 - a2) + a2))
    return (1 - fresnel) * base * (1 - metallic) / math.pi + fresnel * d * v


@needs_llvm
@pytest.mark.parametrize(
    ("roughness", "metallic", "specular"), [(1.0, 0.0, 1.0), (0.5, 1.0, 1.0), (0.3, 0.4, 0.5)]
)
def test_glossy_reflection_is_our_own_model(roughness, metallic, specular) -> None:
    material = Material(
        base_color=(0.6, 0.4, 0.2), roughness=roughness, metallic=metallic, specular=specular
    )
    light = np.array([0.6, 0.8, 0.0])
    camera = Camera(position=(-4.0, 3.0, 0.0), target=(0, 0, 0), fov_y_deg=0.5)
    view = np.array([-0.8, 0.6, 0.0])
    half = (light + view) / np.linalg.norm(light + view)
    sun = DirectionalLight(tuple(-light), (2.0, 2.0, 2.0))
    scene = Scene(meshes=(floor(material),), lights=(sun,), camera=camera)
    image = mitsuba.render(scene, size=(2, 2), spp=4, max_depth=2)
    f = gltf_reflection(
        material.base_color, roughness, metallic, specular, 0.8, 0.6, half[1], view @ half
    )
    np.testing.assert_allclose(image.radiance[0, 0], f * 0.8 * 2.0, rtol=0.01)
    assert image.stats["variant"] == "llvm_ad_rgb" and not image.stats["approximations"]


@needs_llvm
def test_layers_of_a_foggy_scene_add_up_to_mitsubas_own_image() -> None:
    floor_ = floor(LAMBERT)
    wall = dataclasses.replace(
        floor(Material(base_color=(0.2, 0.6, 0.8), roughness=0.4)),
        world_from_object=np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, -1.5], [0, 0, 0, 1]]),
    )
    scene = Scene(
        meshes=(floor_, wall),
        lights=(PointLight((0.5, 1.0, 0.0), (2, 2, 2)),),
        environment=Environment(radiance=(0.1, 0.2, 0.3)),
        medium=Medium(sigma_t=(0.1, 0.2, 0.3), albedo=(0.9, 0.9, 0.9), g=(0.3,) * 3),
        camera=Camera(position=(0, 1, 3), target=(0, 0.5, 0)),
    )
    names = ("all", "direct", "indirect", "one_bounce", "single_scatter", "multiple_scatter")
    parts = mitsuba.render_layers(scene, names, size=(24, 16), spp=256)
    whole = sum(
        parts[n].radiance for n in ("direct", "indirect", "single_scatter", "multiple_scatter")
    )
    np.testing.assert_allclose(whole, parts["all"].radiance, rtol=1e-4, atol=1e-5)
    stock = mitsuba.render(scene, size=(24, 16), spp=256, seed=7)
    assert stock.stats["integrator"] == "volpathmis"
    noise = np.sqrt((stock.layers["variance"] + parts["all"].layers["variance"]).sum((0, 1))) / (
        24 * 16
    )
    difference = (stock.radiance - parts["all"].radiance).mean((0, 1))
    assert (np.abs(difference) < 4 * noise).all()
    assert (parts["one_bounce"].radiance.mean() > 0) and (
        parts["one_bounce"].radiance.mean() < parts["indirect"].radiance.mean()
    )


@needs_llvm
def test_layers_of_air_alone() -> None:
    """Single scattering by quadrature, transmittance by Beer-Lambert, and no surface light."""
    scene = air_scene(sigma_t=(0.2, 0.5, 1.0), albedo=(0.9, 0.8, 0.7))
    names = ("single_scatter", "multiple_scatter", "transmittance", "direct")
    parts = mitsuba.render_layers(scene, names, size=(6, 6), spp=2048)
    z = (np.arange(400) + 0.5) / 400 * 2.0
    sigma_t, albedo = np.array([0.2, 0.5, 1.0]), np.array([0.9, 0.8, 0.7])
    depth = np.exp(-sigma_t[None] * (z[:, None] + 1.0))
    expected = (albedo * sigma_t / (4 * math.pi) * 2.0 * depth).mean(0) * 2.0
    np.testing.assert_allclose(parts["single_scatter"].radiance.mean((0, 1)), expected, rtol=0.02)
    through = parts["transmittance"].radiance.mean((0, 1))
    np.testing.assert_allclose(through, np.exp(-2 * sigma_t), rtol=2e-3)
    assert parts["direct"].radiance.max() == 0.0
    assert parts["multiple_scatter"].radiance.mean() > 0.0


def test_the_variance_is_that_of_the_mean() -> None:
    """The spread between independent seeds is what the image says of itself."""
    sky = Environment(radiance=(1, 1, 1), map=np.random.default_rng(0).random((8, 16, 3), "f4"))
    scene = Scene(meshes=(floor(LAMBERT),), environment=sky, camera=from_above())
    images = [quick(scene, (16, 16), 64, seed=seed) for seed in range(3)]
    said = np.mean([p.layers["variance"].mean() for p in images])
    spread = np.var([p.radiance for p in images], axis=0, ddof=1).mean()
    assert 0.6 < said / spread < 1.6
    assert images[0].stats["spp"] == 64
    assert 0.0 < images[0].stats["noise_floor"] < 0.2
    again = quick(scene, (16, 16), 64, seed=1)
    np.testing.assert_array_equal(again.radiance, images[1].radiance)


def test_progress_reaches_one() -> None:
    seen: list[float] = []
    quick(Scene(environment=Environment()), (4, 4), 16, progress=seen.append)
    assert seen == sorted(seen) and seen[-1] == 1.0 and len(seen) >= 4


def test_values_out_of_range_are_refused() -> None:
    with pytest.raises(SettingsError, match=r"unknown reference layer 'dirct'.*'direct'"):
        mitsuba.render_layers(Scene(), ("dirct",))
    with pytest.raises(SettingsError, match="spp = 3 is too few"):
        mitsuba.render(Scene(), spp=3)
    with pytest.raises(SettingsError, match="size 0x4 is impossible"):
        mitsuba.render(Scene(), size=(0, 4))
    with pytest.raises(SettingsError, match="max_depth = 0"):
        mitsuba.render(Scene(), max_depth=0)


def test_without_mitsuba_it_says_what_to_type(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mitsuba_child.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(ReferenceFailure) as caught:
        mitsuba.render(Scene())
    assert str(caught.value) == (
        "Mitsuba is not installed. Type: pip install 'airlight[reference]'"
    )


def test_running_past_the_time_leaves_nothing_behind(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    scene = Scene(meshes=(floor(LAMBERT),), environment=Environment(), camera=from_above())
    with pytest.raises(ReferenceFailure, match=r"Mitsuba took longer than 1\.5 s"):
        quick(scene, (512, 512), 4096, timeout_s=1.5)
    assert list(tmp_path.iterdir()) == []


def test_layers_of_media_without_llvm_are_refused() -> None:
    with pytest.raises(mitsuba.NoLayers, match="need Mitsuba's compiled variant"):
        mitsuba.render_layers(air_scene(sigma_t=1.0), ("single_scatter",), variant="scalar_rgb")
    # A medium that neither scatters nor absorbs is none.
    clear = air_scene(sigma_t=0.0)
    direct = mitsuba.render_layers(clear, ("direct",), size=(4, 4), spp=4, variant="scalar_rgb")
    assert direct["direct"].radiance.shape == (4, 4, 3)


WALLS = ('<translate z="-1"/>', '<rotate y="1" angle="90"/><translate x="-1"/>')
WALLS += ('<rotate y="1" angle="-90"/><translate x="1"/>',)
ROOM = f"""<scene version="3.0.0">
<sensor type="perspective"><float name="fov" value="39.3"/>
<transform name="to_world"><lookat origin="0, 0, 3.9" target="0, 0, 0" up="0, 1, 0"/></transform>
</sensor>
{
    "".join(
        f'<shape type="rectangle"><transform name="to_world">{at}</transform>'
        '<bsdf type="twosided"><bsdf type="diffuse"/></bsdf></shape>'
        for at in WALLS
    )
}
<shape type="rectangle"><transform name="to_world"><scale x="0.25" y="0.2"/>
<rotate x="1" angle="90"/><translate y="0.99"/></transform>
<emitter type="area"><rgb name="radiance" value="18, 14, 7"/></emitter></shape>
</scene>"""


def test_a_light_seen_along_its_own_plane_has_finite_layers(tmp_path: Path) -> None:
    """Of walls beside a light the densities of directions towards it have no bound."""
    (tmp_path / "a.xml").write_text(ROOM)
    scene = load(tmp_path / "a.xml")
    images = mitsuba.render_layers(scene, ("all", "direct"), size=(128, 128), spp=64, seed=2)
    for image in images.values():
        assert np.isfinite(image.radiance).all() and image.stats["approximations"] == []
