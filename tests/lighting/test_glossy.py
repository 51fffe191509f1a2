"""Mirrored rays through lattices whose light and walls are known."""

from __future__ import annotations

import re

import numpy as np
import pytest

from airlight.gpu.memory import Texture, buffer_of, linear_sampler
from airlight.gpu.slots import sampler, storage, texture, uniform
from airlight.gpu.source import LIBRARIES
from airlight.lattice.placement import LatticeParams, Placement
from airlight.lighting.glossy import is_any_glossy
from airlight.rendering import Renderer
from airlight.scene import Camera, Material, PointLight, Scene
from airlight.scene import Texture as SceneTexture

COUNT = (24, 16, 14)  # x, y, z
LIGHT = 2.0  # a of every lit cell

_KERNEL = """
//! use glossy
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= arrayLength(&rays) / 4u) { return; }
    let surface = rays[4u * id.x].xyz;
    let n = rays[4u * id.x + 1u].xyz;
    let r = rays[4u * id.x + 2u];
    let lookup = rays[4u * id.x + 3u].xyz;
    let ray = GlossyRay(n, r.xyz, r.w, GLOSSY_START);
    let found = glossy_walk(lattice, surface, lookup, ray, glossy_begun(), true);
    let end = lattice_irradiance_at(lattice, found.uvw, r.xyz);
    results[2u * id.x] = vec4f(found.irradiance + found.lit * end, found.left);
    results[2u * id.x + 1u] = vec4f(found.uvw * vec3f(lattice.count), found.lit);
}
"""

_SLOTS = (
    uniform("lattice", LatticeParams),
    *(texture(f"lattice_{name}", "3d") for name in ("red", "green", "blue")),
    *(texture(f"lattice_{name}", "3d") for name in ("visibility_a", "visibility_b", "walls")),
    sampler("linear_clamp"),
    storage("rays", "vec4f"),
    storage("results", "vec4f", "read_write"),
)


class Cells:
    """States and open shares of a lattice, indexed [z, y, x]."""

    def __init__(self):
        x, y, z = COUNT
        self.state = np.zeros((z, y, x, 4))
        self.open = np.ones((z, y, x, 6))  # of hops that enter the cell: +x -x +y -y +z -z

    def wall_before_x(self, x, share=1.0):
        """A wall on the faces between the cells x - 1 and x."""
        self.open[:, :, x, 0] = self.open[:, :, x - 1, 1] = 1.0 - share


@pytest.fixture
def followed(gpu, commands, owned, kernel):
    """followed(cells, surface, n, r, alpha) -> dict of arrays, one row per ray."""

    def follow(cells, surface, n, r, alpha):
        surface, n, r, alpha = np.broadcast_arrays(
            np.atleast_2d(surface), np.atleast_2d(n), np.atleast_2d(r), np.reshape(alpha, (-1, 1))
        )
        rays = np.zeros((len(r), 4, 4), np.float32)
        rays[:, 0, :3], rays[:, 1, :3], rays[:, 3, :3] = surface, n, surface + 0.5 * n
        rays[:, 2, :3], rays[:, 2, 3] = r / np.linalg.norm(r, axis=1, keepdims=True), alpha[:, 0]

        def volume(name, format, values):
            made = owned(Texture(gpu, name, COUNT, format, dimension="3d"))
            made.write(values)
            return made

        light = volume("light", "rgba16float", cells.state.astype(np.float16))
        shares = np.round(cells.open * 255).astype(np.uint8)
        rest = np.full_like(shares[..., :4], 255)
        rest[..., :2] = shares[..., 4:]
        rest[..., 2:] = shares[..., 0:4:2]
        given = owned(buffer_of(gpu, "rays", rays))
        results = owned(buffer_of(gpu, "results", np.zeros((len(rays), 2, 4), np.float32)))
        kernel(_KERNEL, _SLOTS).dispatch(
            commands,
            (len(rays),),
            lattice=Placement((0, 0, 0), 1.0, COUNT).params(1.0),
            lattice_red=light,
            lattice_green=light,
            lattice_blue=light,
            lattice_visibility_a=volume(
                "open a", "rgba8unorm", np.ascontiguousarray(shares[..., :4])
            ),
            lattice_visibility_b=volume("open b", "rgba8unorm", rest),
            lattice_walls=volume("walls", "rgba8snorm", np.zeros_like(rest, np.int8)),
            linear_clamp=linear_sampler(gpu),
            rays=given,
            results=results,
        )
        commands.submit()
        rows = results.read().reshape(-1, 2, 4)
        return {"e": rows[:, 0, 0], "left": rows[:, 0, 3], "place": rows[:, 1, :3]}

    return follow


FLOOR = ((4.0, 8.0, 7.0), (1.0, 0.0, 0.0))  # a point on a wall at x = 4, and its normal


def isotropic(followed):
    """Irradiance of a cell that holds LIGHT everywhere, by the shader's own reading."""
    cells = Cells()
    cells.state[..., 0] = LIGHT
    return float(followed(cells, *FLOOR, (1, 0, 0), 1.0)["e"][0])


def test_uniform_light_in_a_closed_room_is_seen_unchanged_every_way(followed):
    cells = Cells()
    cells.state[..., 0] = LIGHT
    cells.open[[0, -1]] = cells.open[:, [0, -1]] = cells.open[:, :, [0, -1]] = 0.0
    rng = np.random.default_rng(3)
    r = rng.normal(size=(200, 3))
    r[:, 0] = np.abs(r[:, 0])
    for alpha in (0.002, 0.1, 1.0):
        e = followed(cells, *FLOOR, r, alpha)["e"]
        unstopped = followed(cells, *FLOOR, r, alpha)["left"] > 0.0
        np.testing.assert_allclose(e[~unstopped], isotropic(followed), rtol=0.04)


def test_a_lit_wall_far_off_is_mirrored_and_the_air_before_it_is_not(followed):
    cells = Cells()
    cells.wall_before_x(14)
    cells.state[:, :, 13, 0] = LIGHT
    hit = followed(cells, *FLOOR, (1, 0.1, 0), 0.01)
    assert hit["e"][0] == pytest.approx(isotropic(followed), rel=0.01)
    assert hit["left"][0] == 0.0
    aside = followed(cells, *FLOOR, (0.02, 1, 0), 0.01)
    assert aside["e"][0] == pytest.approx(0.0, abs=1e-6)
    assert aside["left"][0] == 1.0


def test_what_lies_behind_a_wall_is_not_mirrored(followed):
    cells = Cells()
    cells.wall_before_x(14)
    cells.state[:, :, 14:, 0] = LIGHT
    assert followed(cells, *FLOOR, (1, 0.1, 0), 0.01)["e"][0] == pytest.approx(0.0, abs=1e-6)


def test_half_a_wall_gives_half_its_light_and_half_of_what_is_behind(followed):
    cells = Cells()
    cells.wall_before_x(9, share=0.5)
    cells.wall_before_x(14)
    cells.state[:, :, 8, 0] = LIGHT
    cells.state[:, :, 13, 0] = 3.0 * LIGHT
    e = followed(cells, *FLOOR, (1, 0, 0), 0.01)["e"][0]
    assert e == pytest.approx((0.5 + 1.5) * isotropic(followed), rel=0.03)


def test_a_rough_surface_takes_the_light_before_it(followed):
    cells = Cells()
    cells.wall_before_x(14)
    cells.state[:, :, 13, 0] = LIGHT
    rough = followed(cells, *FLOOR, (1, 0, 0), 1.0)
    assert rough["e"][0] == pytest.approx(0.0, abs=1e-6)
    assert np.linalg.norm(rough["place"][0] - FLOOR[0]) < 1.2
    # and between the two the ray grows longer the smoother the surface
    far = followed(cells, *FLOOR, (1, 0, 0), [0.8, 0.4, 0.2, 0.1])["place"][:, 0]
    assert (np.diff(far) > 0.3).all()


def test_no_edges_as_the_ray_turns(followed):
    """Partly open cells here and there, and light that varies slowly: an image without steps."""
    rng = np.random.default_rng(5)
    cells = Cells()
    coarse = rng.random((4, 4, 4))
    z, y, x = np.meshgrid(*(np.linspace(0, 3, n) for n in COUNT[::-1]), indexing="ij")
    cells.state[..., 0] = LIGHT * coarse[z.astype(int), y.astype(int), x.astype(int)]
    for axis in range(3):
        cells.state[..., 0] = (
            cells.state[..., 0]
            + np.roll(cells.state[..., 0], 1, axis)
            + np.roll(cells.state[..., 0], -1, axis)
        ) / 3
    cells.open[...] = 0.8
    angle = np.linspace(-1.2, 1.2, 4001)
    r = np.stack([np.cos(angle), np.sin(angle), 0.3 * np.ones_like(angle)], axis=-1)
    e = followed(cells, (4.0, 8.3, 7.4), FLOOR[1], r, 0.05)["e"]
    assert e.std() > 0.01 * e.mean()
    assert np.abs(np.diff(e)).max() < 0.02 * e.mean()


def test_a_slanted_surface_does_not_stop_its_own_rays(followed):
    """Its steps, as blockers round it to cell faces, lie in the way of rays along it."""
    cells = Cells()
    n = np.array([1.0, 1.0, 0.0]) / np.sqrt(2)
    for y in range(1, 15):  # the plane x + y = 16, open side towards +x +y
        x = 16 - y
        cells.open[:, y, x, 1] = cells.open[:, y, x - 1, 0] = 0.0
        cells.open[:, y, x, 3] = cells.open[:, y - 1, x, 2] = 0.0
    cells.state[..., 0] = LIGHT
    along = followed(cells, (8.0, 8.0, 7.0), n, (1.0, -0.8, 0.0), 0.01)
    assert along["left"][0] > 0.6


def _share(gain, roughness):
    """glossy_share of wgsl/surface_reflection.wgsl, its numbers read from there."""
    text = (LIBRARIES[0] / "surface_reflection.wgsl").read_text()
    low, high = map(float, re.search(r"smoothstep\(([\d.]+), ([\d.]+), gain", text).groups())
    t = np.clip((gain * (1.0 - roughness) - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def _dielectric_gain(roughness):
    """specular_albedo of wgsl/surface_reflection.wgsl for f0 = 0.04, at its largest angle."""
    n_v = np.linspace(1e-4, 1.0, 500)
    c = np.array([-1.0, -0.0275, -0.572, 0.022]) * roughness + [1.0, 0.0425, 1.04, -0.04]
    a = np.minimum(c[0] ** 2, np.exp2(-9.28 * n_v)) * c[0] + c[1]
    return float((0.04 * (c[2] - 1.04 * a) + c[3] + 1.04 * a).max())


@pytest.mark.parametrize("roughness", [0.1, 0.5, 0.64, 0.66, 0.8, 0.95, 0.98, 1.0])
def test_scenes_that_the_shader_would_not_mirror_are_told_apart(roughness):
    plastic = Material(roughness=roughness)
    assert is_any_glossy([plastic]) >= (_share(_dielectric_gain(roughness), roughness) > 0.0)
    metal = Material(roughness=roughness, metallic=1.0, base_color=(1, 1, 1))
    assert is_any_glossy([metal]) >= (_share(1.0, roughness) > 0.0)
    assert not is_any_glossy([Material(roughness=roughness, specular=0.0)])


def test_a_texture_may_make_a_rough_material_smooth():
    polished = np.full((2, 2, 4), 255, np.uint8)
    polished[0, 0, 1] = 25
    image = SceneTexture(polished, is_srgb=False)
    assert not is_any_glossy([])
    assert not is_any_glossy([Material()])
    assert is_any_glossy([Material(), Material(metallic_roughness_texture=image)])


def test_a_metal_plate_shows_the_wall_across_the_room(gpu, square):
    """Red left half, dark right half; the plate faces them from 3 m away."""
    red = Material(base_color=(0.9, 0.05, 0.05), specular=0.0)
    black = Material(base_color=(0.01, 0.01, 0.01), specular=0.0)
    metal = Material(base_color=(0.95, 0.95, 0.95), metallic=1.0, roughness=0.1)
    meshes = (
        square((-1, 1, 1.5), (0, 1, 0), (1, 0, 0), red),
        square((1, 1, 1.5), (0, 1, 0), (1, 0, 0), black),
        square((0, 1, -1.5), (2, 0, 0), (0, 1, 0), metal),
    )
    scene = Scene(
        meshes=meshes,
        lights=(PointLight((0, 1, 0), (10, 10, 10)),),
        camera=Camera((0, 1, 1.2), (0, 1, -1.5), fov_y_deg=45),
    )
    contrast = {}
    for rays in (False, True):
        given = {"resolution": 16, "surfels": 20_000, "glossy_rays": rays, "iterations": 24}
        with Renderer(scene, "lpv", (48, 36), settings=given) as renderer:
            seen = renderer.frame().layers["indirect"][12:24, :, 0]
        left, right = seen[:, 14:22].mean(), seen[:, 26:34].mean()
        contrast[rays] = left / right
    assert contrast[True] > 1.5 * contrast[False]
    assert contrast[True] > 2.5
