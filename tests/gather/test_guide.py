"""Rays that are guided to what lights shine on."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gather.guide import LightPatch, LitTile, PatchesOfTiles, PatchParams
from airlight.gpu.memory import Buffer, Texture, buffer_of
from airlight.gpu.slots import storage
from airlight.maths.gather import lobe_density
from airlight.maths.light_guide import PATCHES, guide_density, guided_share
from airlight.maths.sampling import fibonacci_sphere
from airlight.rendering import render
from airlight.scene import Camera, Material, Medium, Mesh, PointLight, Scene, SpotLight
from airlight.scene.shapes import box

SIZE = (48, 32)
LPV = {"resolution": 8, "lamp_resolution": 128, "map_resolution": 64, "iterations": 16}
ROOM = Mesh(box(), Material(base_color=(0.5,) * 3, specular=0.0), np.diag((4.0, 4.0, 4.0, 1.0)))
EYE = Camera((0.0, 0.0, 1.9), (0.0, -0.5, -2.0), fov_y_deg=60.0)
SPOT = SpotLight((0.0, 1.5, 0.0), (-1.0, 0.0, 0.0), (2000.0,) * 3, 1.6, 2.2)


def indirect(light, samples, guided):
    settings = {**LPV, "gather_guided": guided}
    return render(
        Scene((ROOM,), (light,), camera=EYE), "lpv", SIZE, samples=samples, settings=settings
    ).layers["indirect"]


def test_a_small_lit_patch_is_not_found_by_luck():
    """A spot of .15 m on the wall of a room of 4 m is all that lights it."""
    truth, found = indirect(SPOT, 12, 2), indirect(SPOT, 2, 2)
    by_luck = indirect(SPOT, 2, 0)
    cap = np.percentile(truth, 99)
    off, far_off = (
        np.linalg.norm(np.minimum(image, cap) - np.minimum(truth, cap)) / np.linalg.norm(truth)
        for image in (found, by_luck)
    )
    # Two samples, 12 and 8 rays of later segments: .112 (.080 with 16 of each and one image).
    assert off < 0.12
    assert off < 0.3 * far_off


def test_guided_rays_bring_no_more_light_than_others():
    """The means of a spot large enough that rays by the cosine converge are the same."""
    wide = SpotLight((0.0, 1.5, 0.0), (-1.0, -0.5, 0.0), (100.0,) * 3, 12.0, 14.0)
    with_guide, without = (indirect(wide, 60, guided).mean() for guided in (4, 0))
    assert with_guide == pytest.approx(without, rel=0.01)


def test_where_light_is_wide_nothing_is_guided():
    """A point light in the middle lights all walls: the image is the same to the bit."""
    light = PointLight((0.0, 0.0, 0.0), (10.0,) * 3)
    np.testing.assert_array_equal(indirect(light, 1, 2), indirect(light, 1, 0))


def patches_of(gpu, commands, tiles):
    """What one workgroup makes of `tiles`, seen by a point 1 m above each of 4 x 4 places."""
    x, z = np.meshgrid(np.linspace(-3.0, 3.0, 4), np.linspace(-3.0, 3.0, 4))
    places = np.stack([x, np.full_like(x, 2.0), z, np.ones_like(x)], axis=-1)
    normals = np.broadcast_to([0.0, -1.0, 0.0, 0.0], places.shape)
    made = Buffer(gpu, "patches", LightPatch.dtype.itemsize * (PATCHES + 1))
    PatchesOfTiles(gpu).dispatch(
        commands,
        (256,),
        params=PatchParams(reduced=(4, 4), count=len(tiles)),
        places=image_of(gpu, places),
        normals=image_of(gpu, normals),
        tiles=buffer_of(gpu, "tiles", tiles),
        lit_patches=made,
    )
    commands.submit()
    return made.read(LightPatch.dtype)


def image_of(gpu, values):
    made = Texture(gpu, "points", values.shape[1::-1], "rgba32float")
    made.write(np.ascontiguousarray(values, dtype=np.float32))
    return made


def lit_tiles(centres, seen):
    tiles = np.zeros(len(centres), LitTile.dtype)
    tiles["centre"], tiles["radius"], tiles["flux"] = centres, 0.1, 1.0
    tiles["normal"], tiles["seen"] = (0.0, 1.0, 0.0), seen
    return tiles


def test_patches_are_of_tiles_that_are_near_to_each_other(gpu, commands):
    """Four spots of .4 m, 2 m apart, whose tiles lie in no order: no patch reaches two of them."""
    rng = np.random.default_rng(11)
    spots = np.array([(-1.0, 0.0, -1.0), (1.0, 0.0, -1.0), (-1.0, 0.0, 1.0), (1.0, 0.0, 1.0)])
    offsets = rng.uniform(-0.2, 0.2, (320, 3)) * (1.0, 0.0, 1.0)
    found = patches_of(gpu, commands, lit_tiles(spots[rng.permutation(320) % 4] + offsets, 1.0))
    lit = found[:PATCHES]
    assert found["radius"][PATCHES] == PATCHES
    # All light is in them, each within a spot, and no larger than half of one and a tile.
    assert lit["flux"].sum() == pytest.approx(320.0, rel=1e-3)
    nearest = np.linalg.norm(lit["centre"][:, None] - spots, axis=2).min(axis=1)
    assert nearest.max() < 0.3
    assert np.median(lit["radius"]) < 0.1 + 0.5 * 0.4


def test_what_no_point_sees_makes_no_patch(gpu, commands):
    """Tiles of one block on two planes, as on the both sides of a wall: one side alone counts."""
    centres = np.zeros((64, 3))
    centres[:, 0] = np.linspace(-0.5, 0.5, 64)
    centres[1::2, 1] = -0.5
    seen = np.where(np.arange(64) % 2, 0.0, 1.0)
    lit = patches_of(gpu, commands, lit_tiles(centres, seen))[:PATCHES]
    np.testing.assert_allclose(lit["centre"][:, 1], 0.0, atol=1e-6)
    assert lit["flux"].sum() == pytest.approx(32.0, rel=1e-3)


DENSITY = """
//! use light_guide
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= arrayLength(&result)) { return; }
    let density = guide_density(vec3f(0.5, 0.0, -0.5), vec3f(0.0, 1.0, 0.0), asked[id.x].xyz);
    var cones: PatchCones;
    let choice = guide_choice(vec3f(0.5, 0.0, -0.5), vec3f(0.0, 1.0, 0.0), 0.5, &cones);
    let again = density_of_cones(&cones, choice.total, asked[id.x].xyz);
    result[id.x] = vec4f(density, again, choice.found, 0.0);
}
"""


def random_patches():
    rng = np.random.default_rng(5)
    rows = rng.normal(size=(PATCHES + 1, 8))
    rows[:, 3], rows[:, 7] = rng.uniform(0.05, 1.0, PATCHES + 1), 1.0 + rng.random(PATCHES + 1)
    rows[:, 4:7] /= 2.0 * np.linalg.norm(rows[:, 4:7], axis=1, keepdims=True)
    rows[PATCHES] = [0.0, 0.0, 0.0, PATCHES, 0.0, 0.0, 0.0, 0.0]
    return rows


def answers(gpu, kernel, commands, code, rows, asked, **constants):
    """What `code` makes of each vec4f of `asked`, with these patches."""
    slots = (
        storage("lit_patches", LightPatch),
        storage("asked", "vec4f"),
        storage("result", "vec4f", "read_write"),
    )
    asked = asked.astype(np.float32)
    result = Buffer(gpu, "result", asked.nbytes)
    made = kernel(code, slots)
    type(made)(gpu, constants=constants).dispatch(
        commands,
        (len(asked),),
        lit_patches=buffer_of(gpu, "patches", rows.astype(np.float32)),
        asked=buffer_of(gpu, "asked", asked),
        result=result,
    )
    commands.submit()
    return result.read().reshape(-1, 4)


def test_rays_are_guided_as_densely_as_the_twin_says(gpu, kernel, commands):
    rows, directions = random_patches(), fibonacci_sphere(4000)
    asked = np.column_stack([directions, np.zeros(4000)])
    got = answers(gpu, kernel, commands, DENSITY, rows, asked)
    want, found = guide_density(rows[:PATCHES], (0.5, 0.0, -0.5), (0.0, 1.0, 0.0), directions)
    assert want.max() > 0.0
    np.testing.assert_allclose(got[:, 2], found, rtol=1e-4)
    # Where a patch has been chosen, its cone and the others' are known already.
    np.testing.assert_allclose(got[:, 1], got[:, 0], rtol=1e-5, atol=1e-6)
    # At a cone's very edge single precision may say otherwise.
    off = np.abs(got[:, 0] - want) > 1e-3 * want + 1e-5
    assert off.mean() < 2e-3


AIR = """
//! use guide_air
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= arrayLength(&result)) { return; }
    let sent = air_ray(vec3f(0.5, 0.0, -0.5), vec4f(0.0, -1.0, 0.0, 0.4), asked[id.x].xy);
    result[id.x] = vec4f(sent.direction, sent.density);
}
"""


def test_rays_in_the_air_are_as_dense_as_the_twin_says(gpu, kernel, commands):
    """By the lobe and towards small patches; over all of them 1/density is the sphere."""
    rows = random_patches()
    rows[:PATCHES, 3] *= 0.2
    rng = np.random.default_rng(6)
    numbers = np.column_stack([rng.random((60000, 2)), np.zeros((60000, 2))])
    got = answers(gpu, kernel, commands, AIR, rows, numbers, FROM_AIR=1.0)
    place, up = (0.5, 0.0, -0.5), np.array([0.0, 1.0, 0.0])
    led, found = guide_density(rows[:PATCHES], place, up, got[:, :3], mean_cosine=0.4)
    part = guided_share(found)
    assert part > 0.2
    want = (1.0 - part) * lobe_density(got[:, :3] @ up, 0.4) + part * led
    # At a cone's very edge single precision may say otherwise.
    assert (np.abs(got[:, 3] - want) > 2e-3 * want).mean() < 2e-3
    assert (1.0 / got[:, 3]).mean() == pytest.approx(4.0 * np.pi, rel=0.01)


def in_fog(light, samples, guided):
    air = Medium((0.02,) * 3, (0.9,) * 3, g=(0.3,) * 3)
    settings = {**LPV, "gather_guided": guided}
    scene = Scene((ROOM,), (light,), camera=EYE, medium=air)
    return render(scene, "lpv-scatter", SIZE, samples=samples, settings=settings).layers[
        "multiple_scatter"
    ]


def test_a_small_lit_patch_leaves_no_blobs_in_fog():
    """Each cell sends few rays: those that met the patch by luck were bright blobs (.92; .10)."""
    truth, found, by_luck = (in_fog(SPOT, *k) for k in ((24, 2), (2, 2), (2, 0)))
    off, far_off = (
        np.linalg.norm(image - truth) / np.linalg.norm(truth) for image in (found, by_luck)
    )
    assert off < 0.15
    assert off < 0.3 * far_off
