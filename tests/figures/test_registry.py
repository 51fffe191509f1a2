"""Every figure, drawn from pretended images: that it is drawn, kept, and told in numbers."""

from __future__ import annotations

import json
from types import SimpleNamespace

import numpy as np
import pytest

from airlight.app import cli
from airlight.figures import lpvms_6, registry
from airlight.figures.clpv_11_boxes import MODES, floor_behind, three_boxes
from airlight.figures.panels import Request, rendered
from airlight.figures.registry import FIGURES
from airlight.reference import mitsuba
from airlight.scene.image import Image

PRETENDED = [
    name
    for name in FIGURES
    if not name.startswith("pop-") and name not in ("clpv-5", "clpv-debug", "lpvms-3")
]
PASSES = {
    "reflective shadow maps": 1.0,
    "inject": 2.0,
    "blockers": 3.0,
    "propagate": 4.0,
    "pack": 5.0,
    "lighting": 6.0,
    "g-buffer": 7.0,
}


class Renderer:
    """An image that is brighter downwards, and brighter with every frame."""

    def __init__(self, scene, technique, size, *, settings, adapter):
        self.scene, self.size, self.settings = scene, size, settings
        self.frame_ms, self.python_ms = [], []
        self.meshes = SimpleNamespace(move=lambda meshes: None)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        return None

    def frame(self, *, lights=None, camera=None, samples=1, read=True):
        self.frame_ms.append(10.0 + len(self.frame_ms))
        self.python_ms.append(1.0)
        if not read:
            return None
        ramp = np.linspace(0.1, 0.5, self.size[1], dtype=np.float32)[:, None, None]
        light = np.broadcast_to(ramp, (self.size[1], self.size[0], 3)) * len(self.frame_ms)
        layers = {"direct": light, "indirect": 0.5 * light, "albedo": np.full_like(light, 0.5)}
        up = np.zeros_like(light)
        up[..., 1] = 1.0
        layers |= {"normal": up, "depth": np.full(light.shape[:2], 3.0, np.float32)}
        layers |= {"single_scatter": 0.0 * light, "multiple_scatter": 0.0 * light}
        return Image(1.5 * light, layers, stats=self.stats())

    def timed_passes(self):
        return PASSES

    def stats(self):
        side = self.settings.get("resolution", 32)
        return {
            "lattice": [side, side, side],
            "iterations": self.settings.get("iterations", 64),
            "device": "a test",
            "adapter_type": "CPU",
            "peak_gpu_bytes": 1,
            "triangles": 2,
            "size": list(self.size),
            "frame_ms": 10.0,
            "first_image_s": 1.0,
        }


def pretended_layers(scene, names, *, size, spp, seed, timeout_s, progress):
    shape = (size[1], size[0], 3)
    stats = {"spp": spp, "seconds": 1.0, "approximations": []}
    layers = {"variance": np.zeros(shape, np.float32)}
    return {name: Image(np.full(shape, 0.2, np.float32), layers, stats=stats) for name in names}


@pytest.fixture
def pretended(monkeypatch, tmp_path):
    import airlight.rendering

    monkeypatch.setattr("airlight.app.bench.frames.counted", lambda renderer: {})
    monkeypatch.setattr(airlight.rendering, "Renderer", Renderer)
    monkeypatch.setattr(mitsuba, "render_layers", pretended_layers)
    monkeypatch.setenv("AIRLIGHT_CACHE", str(tmp_path / "cache"))


def test_without_a_libllvm_figures_of_fog_have_a_truth_without_layers(
    pretended, monkeypatch, tmp_path, capsys
):
    def whole_alone(scene, names, **asked):
        if names != ("all",):
            raise mitsuba.NoLayers("no libLLVM 16 is found", remedy="Install it.")
        return pretended_layers(scene, names, **asked)

    monkeypatch.setattr(mitsuba, "render_layers", whole_alone)
    assert cli.run(["figure", "lpvms-7", "--quick", "-o", str(tmp_path), "-q"]) == 0
    note = "only the whole image has a reference: no libLLVM 16 is found. Install it"
    assert capsys.readouterr().err == f"warning: lpvms-7: {note}\n"
    (told,) = json.loads((tmp_path / "lpvms-7.json").read_text("utf-8"))["numbers"].values()
    assert (told["notes"], told["layers"]) == ([note], {})
    assert told["energy_ratio"] > 0.0

    # Failures of a lattice are scored by layers alone: that leaves the image.
    monkeypatch.setattr(lpvms_6, "CASES", dict(list(lpvms_6.CASES.items())[:1]))
    lacks: list[str] = []
    (told,) = lpvms_6.draw(Request((48, 28), warn=lacks.append)).numbers.values()
    assert told["path traced"] == {"spp": Request().reference_spp, "notes": [note]}
    assert told["ours"].keys() == {"mean_indirect"}
    assert lacks == [note]


@pytest.mark.parametrize("name", PRETENDED)
def test_a_figure_is_an_image_and_its_numbers(pretended, tmp_path, name):
    drawn = FIGURES[name].draw(Request((48, 27), quick=True))
    assert drawn.image.dtype == np.uint8
    assert drawn.image.shape[2] == 3
    registry.keep(name, drawn, {"command": "c"}, tmp_path)
    told = json.loads((tmp_path / f"{name}.json").read_text("utf-8"))
    assert told["beside"] == FIGURES[name].source
    assert told["numbers"]
    assert not list(tmp_path.glob(".*part*"))


def test_the_paper_s_names_stand_beside_its_numbers(pretended):
    numbers = FIGURES["clpv-table1"].draw(Request((48, 27), quick=True)).numbers
    ours = numbers["stages_ms"]["ours"]
    assert ours == {
        "RSM rendering": (1.0,) * 3,
        "VPL Injection": (2.0,) * 3,
        "GV Injection": (0.0, 3.0, 3.0),
        "Propagation": (9.0,) * 3,
        "LPV Lookup": (6.0,) * 3,
        "Total": (18.0, 21.0, 21.0),
    }
    # The paper's rows add up to its totals, as printed.
    paper = numbers["stages_ms"]["paper"]
    for machine in ("GTX285", "Xbox 360", "PS3"):
        for mode in range(3):
            rows = [paper[name][machine] for name in ours if name != "Total"]
            total = sum(row[min(mode, len(row) - 1)] for row in rows)
            assert total == pytest.approx(paper["Total"][machine][mode], abs=0.16), machine


def test_difference_and_energy_beside_the_path_tracer(pretended):
    schemes = FIGURES["clpv-6"].draw(Request((48, 27), quick=True)).numbers["schemes"]
    # Pretended: indirect light from 0.05 to 0.25, the truth 0.2 everywhere.
    ramp = np.linspace(0.05, 0.25, 27)
    assert schemes["ours"]["energy_ratio"] == pytest.approx(ramp.mean() / 0.2, rel=1e-4)
    relmse = np.mean((ramp - 0.2) ** 2) / (0.2**2 * (1.0 + 1e-4))
    assert schemes["ours"]["relmse"] == pytest.approx(relmse, rel=1e-3)


def test_a_leak_is_told_as_its_share_of_the_light_without_a_wall(pretended):
    leaks = FIGURES["clpv-11"].draw(Request((48, 27), quick=True)).numbers["wall"]
    told = leaks["ours"]["share_of_indirect_light_that_leaks"]
    assert told == {"0.02 m": 1.0, "0.1 m": 1.0, "0.25 m": 1.0}


def test_a_box_that_nothing_sees_casts_no_shadow_and_samples_of_surfaces_bring_it_back(gpu):
    light = {}
    size = (48, 27)
    where = floor_behind(three_boxes().camera, size)
    assert where.any() and not where.all()
    for label in ("our scheme, seen once", "ours"):
        with_box, without = (
            rendered(Request(size), scene, MODES[label]).layers["indirect"][where].sum()
            for scene in (three_boxes(), three_boxes(2))
        )
        light[label] = with_box / without
    # The last box lies wholly behind the first: views do not see it, and it changes nothing.
    assert light["our scheme, seen once"] == pytest.approx(1.0, abs=1e-6)
    # A lattice of two bands keeps part of a shadow: .40 of the light is left at 160 x 90.
    assert light["ours"] < 0.6
