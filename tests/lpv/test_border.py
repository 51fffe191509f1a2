"""A lattice cut out of a larger one holds the larger one's light."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.memory import Buffer, Texture, buffer_of, linear_sampler
from airlight.lattice.inject import Resolve, fixed_point_scale, new_sums
from airlight.lattice.lobes import InjectionTarget
from airlight.lattice.lookup import LatticeStates, LatticeTextures, texture_scale
from airlight.lattice.placement import Placement
from airlight.lpv.border import Border
from airlight.lpv.propagate import Propagate
from airlight.lpv.step import StepKind

OUTER = Placement((0.0, 0.0, 0.0), 0.5, (24, 20, 22))
ITERATIONS = 160
POWER_W = 40.0


def lobes(placement, points, normals, powers):
    """(3, Z, Y, X, 4) of cosine lobes in a lattice; those outside it are left out."""
    cells = np.zeros((3, *placement.count[::-1], 4))
    place = np.floor((points - np.array(placement.origin)) / placement.cell).astype(int)
    inside = ((place >= 0) & (place < placement.count)).all(axis=1)
    for (x, y, z), n, p in zip(place[inside], normals[inside], powers[inside], strict=True):
        cells[:, z, y, x] += p / (4.0 * np.pi) * np.array([1.0, *(2.0 * n)])
    return cells


@pytest.fixture
def nest(gpu, commands, owned):
    """nest(inner, points, normals, powers) -> solved states of OUTER and of the inner lattice."""

    def solve(inner, points, normals, powers):
        # As nested lattices lie in their textures, the finer one first.
        size = (24, OUTER.count[1] + inner.count[1], 24)
        outer = Placement(OUTER.origin, OUTER.cell, OUTER.count, first_row=inner.count[1])
        power, units = texture_scale(POWER_W), fixed_point_scale(POWER_W)
        textures = owned(LatticeTextures(gpu, outer, size))
        visibility_a, visibility_b, walls = (
            owned(Texture(gpu, name, size, format, dimension="3d"))
            for name, format in (("a", "rgba8unorm"), ("b", "rgba8unorm"), ("walls", "rgba8snorm"))
        )
        for texture in (visibility_a, visibility_b):
            texture.write(np.full((*size[::-1], 4), 255, np.uint8))
        solved = {
            **textures.bound,
            "lattice_visibility_a": visibility_a,
            "lattice_visibility_b": visibility_b,
            "lattice_walls": walls,
        }
        faces = owned(Buffer(gpu, "faces", OUTER.cells * 32))
        found = []
        for placement in (outer, inner):
            sums, nbytes = owned(new_sums(gpu, placement)), 3 * placement.cells * 16
            if placement is inner:
                Border(gpu).encode(
                    commands,
                    InjectionTarget(inner, solved["lattice_walls"], sums, units),
                    outer,
                    {**solved, "linear_clamp": linear_sampler(gpu)},
                    faces,
                    power_scale=power,
                )
            own = lobes(placement, points, normals, powers).astype(np.float32)
            base = owned(buffer_of(gpu, "own", np.ascontiguousarray(own)))
            cells = owned(Buffer(gpu, "cells", nbytes))
            Resolve(gpu).encode(commands, placement, sums, base, cells, units)
            steps = owned(Propagate(gpu, placement, StepKind()))
            total = steps.encode(commands, cells, faces, ITERATIONS)
            light = LatticeStates(cells, total)
            textures.encode(commands, light, power, is_shaped=False, placement=placement)
            commands.submit()
            shape = (3, *placement.count[::-1], 4)
            found.append((cells.read() + total.read()).reshape(shape).astype(np.float64))
        return found

    return solve


def sources(seed, count=12):
    rng = np.random.default_rng(seed)
    points = rng.uniform(0.6, 9.4, (count, 3))
    normals = rng.normal(size=(count, 3))
    return points, normals / np.linalg.norm(normals, axis=1, keepdims=True), np.ones(count)


def fluence_error(found, truth):
    a, b = found[..., 0], truth[..., 0]
    return float(np.linalg.norm(a - b) / np.linalg.norm(b))


def test_with_cells_of_the_same_size_it_is_the_same_light(nest):
    inner = Placement((3.0, 2.5, 2.0), 0.5, (12, 10, 14))
    outer, found = nest(inner, *sources(3))
    truth = outer[:, 4:18, 5:15, 6:18]
    # half floats of the larger lattice are what is let in
    assert fluence_error(found, truth) < 2e-3
    assert found[..., 0].sum() == pytest.approx(truth[..., 0].sum(), rel=2e-3)


def test_light_from_outside_alone_comes_in(nest):
    points, normals, powers = sources(4, 30)
    inner = Placement((4.0, 3.0, 3.5), 0.25, (16, 16, 16))
    far = (np.abs(points - (6.0, 5.0, 5.5)) > 2.5).any(axis=1)
    outer, found = nest(inner, points[far], normals[far], powers[far])
    # the same flux through cells of half the side: a quarter in each of eight
    truth = outer[:, 7:15, 6:14, 8:16]
    ratio = found[..., 0].sum() / (8.0 * 0.25 * truth[..., 0].sum())
    assert ratio == pytest.approx(1.0, abs=0.1)
    halved = found.reshape(3, 8, 2, 8, 2, 8, 2, 4).mean(axis=(2, 4, 6)) * 4.0
    assert fluence_error(halved, truth) < 0.15


def test_no_light_comes_from_beyond_the_larger_lattice(nest):
    inner = Placement((11.0, 9.0, 11.5), 0.5, (12, 10, 14))  # a cell, or half, away
    outer, found = nest(inner, *sources(5))
    assert outer.any()
    assert not found.any()
