"""Depth maps as lights see them: exact depths, and redrawn only where something changed."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.scene import DirectionalLight, Material, SpotLight, Texture
from airlight.surface.light_views import light_views
from airlight.surface.shadow import ShadowMaps

SIDE = 32


@pytest.fixture
def room(on_device, square):
    """A floor of 8 m x 8 m and, 2 m above, an occluder of 2 m x 2 m."""
    return on_device(
        square((0, 0, 0), (4, 0, 0), (0, 0, -4)), square((0.5, 2, 0), (1, 0, 0), (0, 0, -1))
    )


def texel_rays(view, side):
    """World points at depth 0 and 1 of every texel: (side, side, 2, 3)."""
    ndc = (np.arange(side) + 0.5) / side * 2.0 - 1.0
    x, y = np.meshgrid(ndc, -ndc)
    world_from_clip = np.linalg.inv(view.clip_from_world)
    ends = []
    for depth in (0.0, 1.0):
        clip = np.stack([x, y, np.full_like(x, depth), np.ones_like(x)], axis=-1)
        world = clip @ world_from_clip.T
        ends.append(world[..., :3] / world[..., 3:])
    return np.stack(ends, axis=2)


def plane_hits(rays, height):
    """Where the texels' rays cross y = height."""
    a, b = rays[..., 0, :], rays[..., 1, :]
    t = (height - a[..., 1]) / (b[..., 1] - a[..., 1])
    return a + t[..., None] * (b - a)


def depth_of(view, points):
    clip = np.concatenate([points, np.ones((*points.shape[:-1], 1))], -1) @ view.clip_from_world.T
    return clip[..., 2] / clip[..., 3]


def snapped(depth):
    """What depths change by where rasterisers move vertices by 1/256 of a texel, as they may."""
    return sum(np.abs(slope) for slope in np.gradient(depth)) / 256


LIGHTS = [
    DirectionalLight((0, -1, 0), (1, 1, 1)),
    DirectionalLight((0.4, -1, 0.2), (1, 1, 1)),
    SpotLight((0.2, 4, 0.1), (0, -1, 0.05), (1, 1, 1), inner_deg=30, outer_deg=35),
]


@pytest.mark.parametrize("light", LIGHTS)
def test_depths_are_those_of_the_nearest_surface(gpu, commands, owned, room, light):
    views = light_views([light], *room.bounds, SIDE)
    maps = owned(ShadowMaps(gpu, "shadows", SIDE, 1))
    maps.encode(commands, room, views)
    commands.submit()
    depth = maps.depth.read(0)
    rays = texel_rays(views[0], SIDE)
    above, below = plane_hits(rays, 2.0), plane_hits(rays, 0.0)
    reach = np.maximum(np.abs(above[..., 0] - 0.5), np.abs(above[..., 2]))
    on_floor = np.maximum(np.abs(below[..., 0]), np.abs(below[..., 2]))
    edge = 0.3  # metres about edges, where a texel may fall either way
    shadowed, free = reach < 1.0 - edge, (reach > 1.0 + edge) & (on_floor < 4.0 - edge)
    assert shadowed.sum() > 10
    assert free.sum() > 100
    for where, hits in ((shadowed, above), (free, below)):
        wanted = depth_of(views[0], hits)
        np.testing.assert_array_less(np.abs(depth - wanted)[where], 2e-5 + snapped(wanted)[where])
    empty = (on_floor > 4.0 + edge) & (reach > 1.0 + edge)
    np.testing.assert_array_equal(depth[empty], 1.0)


def test_holes_of_cut_out_materials_let_light_through(gpu, commands, owned, on_device, square):
    pixels = np.full((2, 2, 4), 255, np.uint8)
    pixels[:, 0, 3] = 0  # the left half is not there
    leaf = Material(base_color_texture=Texture(pixels, wrap=("clamp", "clamp")), alpha_cutoff=0.5)
    uvs = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], np.float32)
    scene = on_device(square((0, 1, 0), (1, 0, 0), (0, 0, -1), leaf, uvs=uvs))
    views = light_views([LIGHTS[0]], np.array([-2.0, 0, -2]), np.array([2.0, 2, 2]), SIDE)
    maps = owned(ShadowMaps(gpu, "shadows", SIDE, 1))
    maps.encode(commands, scene, views)
    commands.submit()
    hit = plane_hits(texel_rays(views[0], SIDE), 1.0)
    x, reach = hit[..., 0], np.abs(hit[..., [0, 2]]).max(axis=-1)
    is_solid = maps.depth.read(0) < 1.0
    assert is_solid[(x > 0.3) & (reach < 0.8)].all()
    assert not is_solid[(x < -0.3) & (reach < 0.8)].any()


def test_only_what_changed_is_redrawn(gpu, commands, owned, room, monkeypatch):
    maps = owned(ShadowMaps(gpu, "shadows", SIDE, 3))
    drawn = []
    original = type(commands).render

    def counting(self, label, **attachments):
        drawn.append(label)
        return original(self, label, **attachments)

    monkeypatch.setattr(type(commands), "render", counting)
    lights = [*LIGHTS]
    for expected in (3, 0):
        maps.encode(commands, room, light_views(lights, *room.bounds, SIDE))
        assert len(drawn) == expected
        drawn.clear()
    lights[1] = DirectionalLight((0.4, -1, 0.3), (1, 1, 1))
    maps.encode(commands, room, light_views(lights, *room.bounds, SIDE))
    assert len(drawn) == 1
    commands.submit()
