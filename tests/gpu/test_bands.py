"""Passes in bands: which rows they have, how long they take, and that they are the same bits."""

from __future__ import annotations

from contextlib import nullcontext

import numpy as np
import pytest
from tests.gpu.small import SMALL

from airlight.gpu import bands
from airlight.gpu.bands import AIM_S, Pace, banded, longest, part
from airlight.gpu.commands import Commands
from airlight.gpu.sliced import SlicedCommands
from airlight.rendering import Renderer
from airlight.scene.io import load

GATHERED = {**SMALL, "gather": "always"}
SIZE = (24, 16)
MAIN = "@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(%s) id: vec3u) {\n    f(id);\n}\n"


def test_the_entry_of_a_band_adds_what_is_before_it():
    text, entry = banded(MAIN % "global_invocation_id")
    assert text.strip() == "fn main(id: vec3u) {\n    f(id);\n}"
    assert "fn banded(@builtin(global_invocation_id) id: vec3u) {" in entry
    assert "main(id + band.first * vec3u(WX, WY, WZ));" in entry
    assert "main(id + band.first);" in banded(MAIN % "workgroup_id")[1]


@pytest.mark.parametrize("text", [MAIN % "num_workgroups", "fn other() {}"])
def test_a_pass_that_needs_all_its_workgroups_has_no_bands(text):
    with pytest.raises(ValueError, match="alone"):
        banded(text)


def told(pace: Pace, count: int, layer: int, row_s: float) -> list[tuple[int, int]]:
    """The bands of a pass whose rows take so long."""
    first, found = 0, []
    while first < count:
        size = pace.next("pass", first, count, layer)
        pace.took("pass", size, size * row_s)
        found.append((first, size))
        first += size
    return found


@pytest.mark.parametrize("seed", range(40))
def test_bands_are_every_workgroup_once(seed):
    rng = np.random.default_rng(seed)
    groups = tuple(int(n) for n in rng.integers(1, 9, 3))
    layers, rows = (groups[axis] for axis in longest(groups))
    seen, pace = np.zeros(groups, int), Pace()
    for _ in range(3):
        for first, count in told(pace, layers * rows, rows, 10.0 ** rng.uniform(-5, 0)):
            begin, size = part(groups, first, count)
            seen[tuple(slice(b, b + s) for b, s in zip(begin, size, strict=True))] += 1
    assert (seen == 3).all()


@pytest.mark.parametrize("row_ms", [0.01, 0.3, 7.0])
def test_bands_come_near_the_time_they_are_to_take(row_ms):
    pace, count = Pace(), 400
    told(pace, count, 1, row_ms * 1e-3)
    found = told(pace, count, 1, row_ms * 1e-3)
    longest_s = max(size for _, size in found) * row_ms * 1e-3
    assert longest_s <= AIM_S + row_ms * 1e-3
    # And there are no more of them than that asks for, twice over.
    assert len(found) <= 2 + 2 * count * row_ms * 1e-3 / AIM_S


def test_a_band_that_was_slow_once_is_soon_forgotten():
    pace = Pace()
    pace.took("pass", 1, 2.0)  # compiled
    told(pace, 400, 1, 1e-4)
    assert len(told(pace, 400, 1, 1e-4)) <= 4


class Counted(SlicedCommands):
    """Counts the bands of passes that have several."""

    divided = 0

    def bands(self, key, count, layer=1):
        for first, size in super().bands(key, count, layer):
            self.divided += first == 0 and size < count
            yield first, size


def drawn(commands: Commands) -> np.ndarray:
    with Renderer(load("builtin:room"), "lpv", SIZE, settings=GATHERED) as r:
        r.view.aim(r.scene.camera, (0.0, 0.0), 0)
        r.view.is_still = True
        r.technique.solve(commands, r.show(r.scene))
        r.technique.draw(commands, r.view)
        commands.submit()
        r.gpu.wait()
        return np.stack([t.read() for t in r.technique.layers(r.view).values()])


def test_an_image_made_in_bands_of_a_row_is_the_same_bits(gpu, monkeypatch):
    monkeypatch.setattr(bands, "AIM_S", 1e-9)
    sliced = Counted(gpu, nullcontext)
    image = drawn(sliced)
    assert sliced.divided > 10  # rays, their light, filters, the sky in cells
    assert np.array_equal(image, drawn(Commands(gpu)))
    assert image.max() > 0.1
