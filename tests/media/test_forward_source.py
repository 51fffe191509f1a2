"""Marching light that was scattered forwards: the closed form of one constant beam."""

import numpy as np

from airlight.fields import ForwardSource, LatticeSource
from airlight.gpu.layout import pack_array
from airlight.gpu.memory import Texture
from airlight.gpu.rows import Table
from airlight.lattice.placement import Placement
from airlight.maths.forward_phase import fused_phase
from airlight.media.gpu_media import GpuMedia
from airlight.media.march.march import March, MarchTargets, Steps
from airlight.media.march.marched_light import MarchedLight
from airlight.media.rays import Rays
from airlight.scene.camera import Camera
from airlight.scene.lights import DirectionalLight, PointLight
from airlight.scene.medium import Medium
from airlight.scene.scene import Scene
from airlight.surface.light_table import LightData, light_rows

BOX = ((-1.0, -0.8, -1.2), (1.0, 1.1, 1.3))
SIGMA, ALBEDO, G = 0.9, 0.8, 0.7


def test_a_beam_is_scattered_by_the_fused_phase_function(gpu, look):
    """The second of two lights shines; its texture's other slab holds nothing."""
    medium = Medium((SIGMA,) * 3, (ALBEDO,) * 3, (G,) * 3, BOX)
    camera = Camera((0.4, 0.3, 4.0), (0.0, 0.0, 0.0), fov_y_deg=40)
    travel, depth = np.array([0.6, 0.0, 0.8]), 1.5
    lights = (PointLight((0, 0, 0), (1, 1, 1)), DirectionalLight(tuple(travel), (1, 1, 1)))
    seen = look(Scene(medium=medium, camera=camera))
    air = GpuMedia(gpu, seen.scene, light_count=0)
    air.update(seen.commands, seen.scene, *seen.scene.bounds)
    rays = Rays(gpu, seen.size, 1)
    placement = Placement((-4.0, -4.0, -4.0), 1.0, (8, 8, 8))
    dark = Texture(gpu, "dark", (8, 8, 8), "rgba16float", dimension="3d")
    open_to_all = Texture(gpu, "open", (8, 8, 8), "rgba16float", dimension="3d")
    open_to_all.write(np.ones((8, 8, 8, 4), np.float16))
    beams = np.zeros((16, 8, 8, 4), np.float16)
    beams[8:] = [1.0, 2.0, 3.0, depth]
    texture = Texture(gpu, "beams", (8, 8, 16), "rgba16float", dimension="3d")
    texture.write(beams)
    table = Table(gpu, "lights", LightData, len(lights))
    table.write(pack_array(LightData, light_rows(lights)))
    bound = {f"lattice_{name}": dark for name in ("red", "green", "blue", "walls")}
    bound |= {"lattice_visibility_a": open_to_all, "lattice_visibility_b": open_to_all}
    blocks = Texture(gpu, "blocks", (2, 2, 4), "rgba16float", dimension="3d")
    blocks.write(np.ascontiguousarray(beams[::4, ::4, ::4]))
    forward = ForwardSource(texture, blocks, table, 2, 2, 0.5, 1.0)
    lattice = LatticeSource(
        placement, bound, 1.0, forward=forward, mean=dark, is_reduced_medium=True
    )
    march = March(gpu, air)
    rays.encode(seen.commands, seen.view)
    L, T = (
        Texture(gpu, n, rays.reduced, "rgba32float", target=True, written=True) for n in ("L", "T")
    )
    march.encode(
        seen.commands,
        rays,
        MarchedLight(lattice=lattice),
        MarchTargets(L, T),
        Steps(cutoff=0.0),
    )
    got, through = seen.read(L), seen.read(T)
    mu = -seen.directions() @ travel
    # Both sides of the reduced medium; it lets more through than the air itself.
    path_m = -np.log(through[..., :1]) / SIGMA
    nodes, weights = np.polynomial.legendre.leggauss(24)
    t = path_m * 0.5 * (nodes + 1.0)
    kept = np.exp(-SIGMA * (1.0 - ALBEDO * G) * t)
    phase = fused_phase(mu[..., None], G, depth + SIGMA * ALBEDO * t)
    along = (kept * phase * weights).sum(axis=-1, keepdims=True) * 0.5 * path_m
    want = 0.5 * np.array([1.0, 2.0, 3.0]) * SIGMA * ALBEDO * along
    np.testing.assert_allclose(got, want, rtol=0.03, atol=1e-4)
    assert got.max() > 0.01
