"""Kernels that leave out what is not needed draw what the others draw."""

from dataclasses import replace

import numpy as np

from airlight.fields import LatticeSource
from airlight.gpu.memory import Texture
from airlight.lattice.placement import Placement
from airlight.media.gpu_media import GpuMedia
from airlight.media.march.kernel import Variant, slots, target_names
from airlight.media.march.kernel_wgsl import generated
from airlight.media.march.march import March, MarchTargets, Steps
from airlight.media.march.marched_light import MarchedLight
from airlight.media.rays import Rays
from airlight.rendering import Renderer
from airlight.scene import Camera, DirectionalLight, Environment, Medium, Scene, Volume

BOX = ((-1.0, -0.8, -1.2), (1.0, 1.1, 1.3))
CELLS = 8


def lattice(gpu, rng):
    """Random states of three channels, their means, everything open."""
    made, means = {}, np.ones((CELLS,) * 3 + (4,), np.float16)
    for c, name in enumerate(("red", "green", "blue")):
        states = rng.normal(size=(CELLS,) * 3 + (4,)).astype(np.float16)
        states[..., 0] = np.abs(states[..., 0])
        means[..., c] = states[..., 0]
        made[f"lattice_{name}"] = states
    for name in ("visibility_a", "visibility_b"):
        made[f"lattice_{name}"] = np.ones((CELLS,) * 3 + (4,), np.float16)
    made["lattice_walls"] = np.zeros((CELLS,) * 3 + (4,), np.float16)
    made["mean"] = means
    bound = {}
    for name, values in made.items():
        bound[name] = Texture(gpu, name, (CELLS,) * 3, "rgba16float", dimension="3d")
        bound[name].write(values)
    mean = bound.pop("mean")
    return LatticeSource(Placement((-2.0,) * 3, 0.5, (CELLS,) * 3), bound, 1.0, mean=mean)


def test_means_alone_are_enough_where_air_scatters_isotropically(gpu, look):
    """Three channels' states or their means; one lattice, or the same as two at one place."""
    medium = Medium((0.9, 0.5, 1.6), (0.9, 0.8, 1.0), bounds=BOX)
    seen = look(Scene(medium=medium, camera=Camera((0.4, 0.3, 4.0), (0.0, 0.0, 0.0), fov_y_deg=40)))
    air = GpuMedia(gpu, seen.scene, light_count=0)
    air.update(seen.commands, seen.scene, *seen.scene.bounds)
    rays = Rays(gpu, seen.size, 1)
    rays.encode(seen.commands, seen.view)
    march = March(gpu, air)
    source = lattice(gpu, np.random.default_rng(5))

    def drawn(given):
        out = [
            Texture(gpu, n, rays.reduced, "rgba32float", target=True, written=True) for n in "LT"
        ]
        march.encode(seen.commands, rays, MarchedLight(lattice=given), MarchTargets(*out))
        return seen.read(out[0])

    means, states = drawn(source), drawn(replace(source, mean=None))
    assert means.max() > 0.1
    np.testing.assert_allclose(means, states, rtol=1e-4, atol=1e-6)
    twice = drawn(replace(source, finer=(source.placement,)))
    np.testing.assert_allclose(twice, means, rtol=1e-4, atol=1e-6)


def test_packed_cells_say_what_the_textures_do(gpu, look):
    """Of walls anywhere and faces open by any share: one lattice, or the same as two."""
    medium = Medium((0.3, 0.2, 0.4), (0.9, 0.8, 1.0), bounds=BOX)
    seen = look(Scene(medium=medium, camera=Camera((0.4, 0.3, 4.0), (0.0, 0.0, 0.0), fov_y_deg=40)))
    air = GpuMedia(gpu, seen.scene, light_count=0)
    air.update(seen.commands, seen.scene, *seen.scene.bounds)
    rays, march = Rays(gpu, seen.size, 1), March(gpu, air)
    rays.encode(seen.commands, seen.view)
    rng = np.random.default_rng(8)
    source, shape = lattice(gpu, rng), (CELLS,) * 3 + (4,)
    told = {
        "visibility_a": ("rgba8unorm", rng.integers(0, 256, shape, np.uint8)),
        "visibility_b": ("rgba8unorm", rng.integers(0, 256, shape, np.uint8)),
        "walls": ("rgba8snorm", rng.integers(-60, 61, shape, np.int8)),
    }
    told["walls"][1][..., 3] = 0  # no wall with air before it: a hint for surfaces
    for name, (kind, texels) in told.items():
        made = Texture(gpu, name, (CELLS,) * 3, kind, dimension="3d")
        made.write(texels)
        source.bound[f"lattice_{name}"] = made

    def drawn(given):
        out = Texture(gpu, "L", rays.reduced, "rgba32float", target=True, written=True)
        light, steps = MarchedLight(lattice=given), Steps(per_cell=3.0)
        march.encode(seen.commands, rays, light, MarchTargets(out), steps)
        return seen.read(out)[..., :3]

    alone, twice = drawn(source), drawn(replace(source, finer=(source.placement,)))
    assert np.linalg.norm(alone - twice) < 2e-3 * np.linalg.norm(twice)


def test_a_kernel_binds_what_it_reads(gpu):
    air = GpuMedia(gpu, Scene(medium=Medium((1.0,) * 3)), light_count=0)
    names = {slot.name for slot in slots(air, Variant(lattice="mean"))}
    assert "lattice_mean" in names
    assert not names & {"sky_mean", "skylit", "forward_lights"}
    assert "forward_lights" in {
        s.name for s in slots(air, Variant(0, "two bands", has_forward=True))
    }
    sharp = Variant(sky="three bands")
    assert "sky_third" in {s.name for s in slots(air, sharp)}
    assert "sky_third" not in {s.name for s in slots(air, Variant(sky="two bands"))}
    assert "LATTICES_AT_ONCE = 2u" in generated(Variant(sky="two bands", levels=2))


def test_two_kernels_where_targets_are_few(gpu, monkeypatch):
    """WebGPU grants 32 bytes a sample: light, the sky's and transmittance would take 48."""
    density = np.random.default_rng(4).random((6, 6, 6)).astype(np.float32)
    volume = Volume((3.0, 4.0, 5.0), density, bounds=((-1, -1, -1), (1, 1, 1)))
    scene = Scene(
        environment=Environment((0.3, 0.4, 0.5)),
        volumes=(volume,),
        lights=(DirectionalLight((0.3, -1.0, -0.4), (3.0, 2.0, 1.0)),),
        camera=Camera((0.3, 0.4, 4.0), (0.0, 0.0, 0.0), fov_y_deg=36),
    )
    settings = {"resolution": 4, "shadow_resolution": 32, "sky_lights": 4, "sky_resolution": 8}
    made = []
    for limit in (80, 32):
        monkeypatch.setitem(gpu.limits, "max-color-attachment-bytes-per-sample", limit)
        with Renderer(scene, "single", (24, 20), settings=settings) as renderer:
            made.append(renderer.frame().layers)
            kernels = renderer.technique.media.image.march._passes
            assert [len(target_names(v)) for v in kernels] == ([3] if limit == 80 else [2, 1])
    for name in ("single_scatter", "transmittance"):
        assert made[0][name].std() > 0.01
        np.testing.assert_allclose(made[1][name], made[0][name], rtol=1e-5, atol=1e-7)
