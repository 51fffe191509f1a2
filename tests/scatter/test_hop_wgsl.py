"""The generated text: which neighbour is which, and that it says what the table says."""

import numpy as np
import pytest

from airlight.maths import lattice26
from airlight.maths.lattice26_levels import mean_track
from airlight.scatter import hop_wgsl


def test_opposites_and_kinds():
    table = lattice26.hops()
    for j in range(26):
        np.testing.assert_array_equal(table.offsets[hop_wgsl.opposite(j)], -table.offsets[j])
        assert table.lengths[j] == pytest.approx(np.sqrt(hop_wgsl.kind(j) + 1))


def test_sums_and_normals_follow_the_offset():
    j = hop_wgsl.offsets().index((1, 0, -1))
    assert hop_wgsl.signed_sum("v", j) == "v.y - v.w"
    assert hop_wgsl.signed_sum("v", j, -1) == "- v.y + v.w"
    assert hop_wgsl.offset_vector(j) == "vec3f(1.0, 0.0, -1.0)"
    x, z = (hop_wgsl.offsets().index(o) for o in ((1, 0, 0), (0, 0, -1)))
    assert hop_wgsl.normal(j) == f"(vec3f(-1.0 * s{x}, 0.0, 1.0 * s{z}) / (s{x} + s{z}))"


def test_every_hop_has_a_byte_of_its_own_in_a_pack():
    places = {hop_wgsl.opened("in", j) for j in range(26)}
    assert len(places) == 26
    assert hop_wgsl.opened("in", 17) == "unpack4x8unorm(in1.x).y"


def test_literals_are_float32_exact():
    for value in (0.053879673181, 1.0, 1e-9, 123456.789):
        text = hop_wgsl.literal(value)
        assert np.float32(float(text)) == np.float32(value)
        assert "." in text


def test_mean_track_is_numpys(gpu, commands, lattice):
    """Through the pack for surfaces, the shorter of its readers."""
    from airlight.lattice.placement import Placement
    from airlight.scatter.surface_light import SurfaceLight

    sigma_t = (1e-3, 0.7, 9.0)
    placement = Placement((0.0, 0.0, 0.0), 0.4, (2, 2, 2))
    ones = np.zeros((3, 2, 2, 2, 4))
    ones[..., 0] = 1.0
    surfaces = SurfaceLight(gpu, placement)
    surfaces.encode(
        commands, lattice(ones), 1.0, medium=None, sigma_s=(0.0, 0.0, 0.0), sigma_t=sigma_t
    )
    commands.submit()
    textures = (surfaces.red, surfaces.green, surfaces.blue)
    got = [t.read()[0, 0, 0, 0] / surfaces.scale for t in textures]
    want = mean_track(np.array(sigma_t), 0.4) / mean_track(0.0, 0.4)
    np.testing.assert_allclose(got, want, rtol=2e-3)
