"""The benchmarks: that they run, that the C does the same work, and what is said about them."""

from __future__ import annotations

import json
import subprocess
from types import SimpleNamespace

import numpy as np
import pytest

from airlight.app import cli
from airlight.app.bench import child as bench_child
from airlight.app.bench import cli as bench
from airlight.app.bench import frames as bench_frames
from airlight.app.bench import growth as bench_growth
from airlight.app.bench import kernel as bench_kernel
from airlight.app.bench import tables as bench_tables
from airlight.errors import AirlightError
from airlight.gpu.memory import buffer_of
from airlight.lattice.placement import Placement
from airlight.lpv.propagate import Propagate
from airlight.lpv.settings import LpvSettings
from airlight.lpv.step import StepKind
from airlight.scene import Camera, DirectionalLight, PointLight
from airlight.scene.builtin import wall_floor


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    made, said = bench_kernel.compiled(tmp_path_factory.mktemp("c"))
    if made is None:
        pytest.skip(said)
    return made


@pytest.mark.parametrize("blocked", [False, True])
def test_the_yardstick_computes_what_the_device_does(program, gpu, commands, owned, blocked):
    side, rng = 8, np.random.default_rng(3)
    cells = side**3
    states = rng.normal(size=(3 * cells, 4)).astype(np.float32)
    states[:, 0] = 1.0 + np.abs(states[:, 0])
    faces = bench_kernel.random_faces(rng, cells)
    placement = Placement((0.0, 0.0, 0.0), 1.0, (side,) * 3)
    ours = owned(Propagate(gpu, placement, StepKind(is_blocked=blocked, is_reflecting=blocked)))
    total = ours.encode(
        commands,
        owned(buffer_of(gpu, "states", states)),
        owned(buffer_of(gpu, "faces", faces)),
        bench_kernel.ITERATIONS,
    )
    commands.submit()
    words = [str(program), "check", str(side), *(["blocked"] if blocked else [])]
    given = states.tobytes() + (faces.tobytes() if blocked else b"")
    done = subprocess.run(words, input=given, capture_output=True, check=True)
    theirs = np.frombuffer(done.stdout, np.float32)
    scale = np.abs(theirs).max()
    np.testing.assert_allclose(total.read() / scale, theirs / scale, atol=2e-6)


def test_without_a_compiler_the_yardstick_is_skipped_and_said(monkeypatch, tmp_path):
    monkeypatch.setattr(bench_kernel.shutil, "which", lambda name: None)
    assert bench_kernel.compiled(tmp_path) == (None, "skipped: there is no C compiler")
    monkeypatch.setattr(bench_kernel, "C_FILE", tmp_path / "propagate.c")
    made, said = bench_kernel.compiled(tmp_path)
    assert made is None
    assert said.startswith("skipped: benchmarks/propagate.c is not here")


def test_both_kernels_take_turns(gpu):
    found = bench_kernel.measure(gpu, 2, (4,))
    assert [case["is_blocked"] for case in found["cases"]] == [False, True]
    for case in found["cases"]:
        assert case["device_ms"]["runs"] == 2
        assert 0.0 < case["device_ms"]["min"] <= case["device_ms"]["median"]
        if "c_ms" in case:
            assert case["ratio_min"] == case["device_ms"]["min"] / case["c_ms"]["min"]


def test_lights_move_a_little():
    sun, light = DirectionalLight((0.6, -0.8, 0.0), (1, 1, 1)), PointLight((0, 1, 2), (1, 1, 1))
    turned, stepped = bench_frames.moved((sun, light), 4)
    assert np.dot(turned.direction, sun.direction) == pytest.approx(
        0.64 + 0.36 * np.cos(np.radians(1.0))
    )
    assert stepped.position == (0.04, 1, 2)
    flown = bench_frames.flown(Camera(position=(1, 2, 3), target=(1, 2, 0)), 4)
    assert (flown.position, flown.target) == ((1.04, 2, 3), (1.04, 2, 0))
    assert bench_frames.spread([3.0, 1.0, 2.0]) == {"median": 2.0, "min": 1.0, "runs": 3}


def test_every_case_has_the_settings_that_are_given():
    *surfaces, foggy = bench.chosen_cases((), {"glossy_rays": "no"}, False)
    assert {case.technique for case in surfaces} == {"lpv"}
    assert all(case.settings["glossy_rays"] == "no" for case in surfaces)
    assert (foggy.technique, foggy.size) == ("lpv-scatter", (1280, 720))
    assert foggy.settings == {"glossy_rays": "no"}
    only_surfaces = bench.chosen_cases((), {"damping": "0.5", "glossy_rays": "no"}, False)
    assert {case.technique for case in only_surfaces} == {"lpv"}


def test_every_axis_varies_what_it_says(monkeypatch):
    scene = wall_floor()
    asked = []

    def measure(varied, case, frames, adapter):
        asked.append((len(varied.lights), len(varied.meshes), case.settings))
        made = {"lattice": [2, 3, 4], "cells": 24, "triangles": 4, "peak_gpu_bytes": 5}
        return made | {"flying_ms": {"median": 1.0}, "passes": {"propagate": 0.5}}

    monkeypatch.setattr(bench_growth, "measure", measure)
    axes = {axis.name: axis for axis in bench_growth.axes()}
    for axis in axes.values():
        rows = bench_growth.table(axis, scene, (8, 8), 1, "auto", {"iterations": 3})["rows"]
        assert [row["value"] for row in rows] == list(axis.values)
        assert rows[0]["cells"] == 24
    assert (1, 2, {"iterations": 3, "resolution": 16}) in asked
    assert (8, 2, {"iterations": 3}) in asked
    assert (1, 1, {"iterations": 3}) in asked
    assert axes["iterations"].is_known(LpvSettings)
    ground = axes["thousand triangles"].vary(scene, 30)[0].meshes[-1].geometry
    assert len(ground.indices) == pytest.approx(30_000, rel=0.02)
    longest = next(a for a in bench_growth.axes(is_long=True) if a.name == "thousand triangles")
    assert longest.values[-1] == 5000
    low, high = scene.bounds
    for light in bench_growth.point_lights(scene, 3):
        assert (light.position >= low).all() and (light.position <= high).all()
        assert light.intensity[0] == pytest.approx(1.0 / 3.0)


def test_a_part_of_it_as_json_and_as_a_page(gpu, tmp_path, capsys):
    out = tmp_path / "bench.json"
    words = ["bench", "--quick", "--only", "frames", "--scene", "builtin:wall-floor", "-q"]
    words += ["-D", "resolution=8", "-o", str(out), "--markdown", "--adapter", gpu.info.name]
    assert cli.run(words) == 0
    page = capsys.readouterr().out
    kept = json.loads(out.read_text("utf-8"))
    assert page == bench_tables.markdown(kept)
    assert page.startswith("airlight ")
    (case,) = kept["frames"]
    assert case["settings"]["resolution"] == "8"
    assert case["frame_ms"]["runs"] == case["flying_ms"]["runs"] == 2
    assert 0.0 < case["python_ms"]["min"] <= case["frame_ms"]["median"]
    assert case["cells"] == np.prod(case["lattice"])
    assert case["peak_gpu_bytes"] > 0
    assert set(case["passes"]) >= {"inject", "propagate", "g-buffer", "lighting"}
    assert f"| {case['name']} | lpv | 96x54 | " in page
    assert "propagation" not in kept and "growth" not in kept


def test_every_table_has_as_many_cells_as_columns():
    times = {"median": 2.0, "min": 1.0, "runs": 3}
    frame = {
        "name": "a",
        "technique": "lpv",
        "size": [4, 3],
        "lattice": [2, 2, 2],
        "iterations": 8,
        "frame_ms": times,
        "flying_ms": times,
        "python_ms": times,
        "peak_gpu_bytes": 3_000_000,
        "passes": {"sky": 1.0},
    }
    row = {"value": 1, "cells": 8, "triangles": 2, "flying_ms": times, "passes": {"sky": 1.0}}
    kernel = {"side": 8, "is_blocked": False, "device_ms": times}
    with_c = kernel | {"is_blocked": True, "c_ms": times, "ratio_min": 1.0, "ratio_median": 2.0}
    machine = dict.fromkeys(
        ("airlight", "device", "adapter_type", "backend", "paths", "cpu_cores", "python", "system"),
        "x",
    )
    results = {
        "machine": machine,
        "frames": [frame],
        "propagation": {"iterations": 8, "c": "cc", "cases": [kernel, with_c]},
        "first_image": [{"name": "a", "size": [4, 3], "seconds": 1.5, "peak_host_bytes": None}],
        "growth": [{"axis": "iterations", "scene": "a", "size": [4, 3], "rows": [row]}],
    }
    made = bench_tables.tables(results)
    assert len(made) == 5
    for table in made:
        assert all(len(cells) == len(table.columns) for cells in table.rows), table.title
    assert "| 8^3, empty | 2 | 1 | - | - | - | - |" in bench_tables.markdown(results)
    assert "| a | 4x3 | 1.50 | - |" in bench_tables.markdown(results)


def test_the_first_image_is_a_process_of_its_own(monkeypatch):
    def run(words, **_):
        assert words[3:5] == ["render", "s.toml"]
        assert words[-2:] == ["-D", "iterations=2"]
        told = json.dumps({"code": 0, "peak_host_bytes": 7})
        return SimpleNamespace(stdout=f"/tmp/first.png\n{told}\n", stderr="")

    monkeypatch.setattr(bench_child.subprocess, "run", run)
    found = bench_child.first_image("s.toml", (8, 4), "lpv", ["iterations=2"], "auto")
    assert found["peak_host_bytes"] == 7
    assert found["size"] == [8, 4]


def test_a_first_image_that_fails_says_why():
    with pytest.raises(AirlightError) as caught:
        bench_child.first_image("nowhere.toml", (8, 4), "lpv", [], "auto")
    assert str(caught.value).startswith(
        "the first image was not made: nowhere.toml: file not found"
    )


def test_the_largest_memory_is_known_where_the_system_tells():
    ballast = np.ones(30_000_000, np.uint8)
    told = bench_child.peak_host_bytes()
    assert told is None or told > ballast.nbytes


def test_cases_are_the_scenes_given_or_the_room_and_the_atrium():
    given = bench.chosen_cases(["rooms/a.obj", "builtin:room"], {"iterations": "4"}, quick=False)
    assert [(case.name, case.size) for case in given] == [
        ("a", (640, 360)),
        ("builtin:room", (640, 360)),
    ]
    assert given[0].settings == {"resolution": 32, "iterations": "4", "map_resolution": 256}
    names = [case.name for case in bench.chosen_cases([], {}, quick=False)]
    assert names[:2] == ["room", "atrium"]


def test_milliseconds_have_no_exponent():
    told = [bench_tables.milliseconds(v) for v in (0.0512, 12.34, 1060.2)]
    assert told == ["0.0512", "12.3", "1,060"]
