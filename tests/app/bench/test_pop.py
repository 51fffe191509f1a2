"""The benchmark of principal ordinates: that it runs, and what is said about it."""

from __future__ import annotations

import numpy as np

from airlight.app.bench import pop as bench_pop
from airlight.app.bench import tables as bench_tables
from airlight.figures.pop_scenes import plume


def test_it_runs_and_is_told_under_the_papers_names(gpu):
    found = bench_pop.measure("auto", lambda stage, fraction: None, quick=True)
    (case,) = found["cases"]
    assert list(case["stages_ms"]) == [*bench_pop.PAPER_MS, "other"]
    assert case["frame_ms"]["median"] > 0.0
    assert case["stages_ms"]["marching"] > 0.0
    assert sum(case["stages_ms"].values()) > 0.5 * sum(case["passes"].values())
    tables = bench_tables.pop_tables(found)
    assert [row[0] for row in tables[0].rows] == [*bench_pop.PAPER_MS, "other", "frame"]
    assert tables[0].rows[-1][-1] == "32"
    assert tables[1].columns[0] == "ordinates"


def test_every_stage_has_one_name():
    passes = {name: 1.0 for names in bench_pop.STAGES.values() for name in names} | {"compose": 5.0}
    told = bench_pop.stages_of(passes)
    assert told["other"] == 5.0
    assert told["merge and upsampling"] == 3.0


def test_the_map_turns_and_the_medium_moves():
    scene = plume()
    turned = bench_pop.moved(scene, 4, moves=False)
    assert turned.environment.rotation_deg == 2.0
    assert turned.volumes is scene.volumes
    moved = bench_pop.moved(scene, 4, moves=True).volumes[0]
    # The same voxels elsewhere: compared in order, since a float32 sum depends on its own.
    before, after = (np.sort(v.density, axis=None) for v in (scene.volumes[0], moved))
    np.testing.assert_array_equal(after, before)
    assert not np.array_equal(moved.density, scene.volumes[0].density)
    finer, settings = bench_pop._with_voxels(scene, 32)
    assert finer.volumes[0].density.shape == (32, 32, 32)
    assert settings == {}
