"""The C yardstick of 26-neighbour propagation computes what the device does, and is timed."""

from __future__ import annotations

import subprocess

import numpy as np
import pytest

from airlight.app.bench import kernel as bench_kernel
from airlight.app.bench import scatter as bench_scatter
from airlight.gpu.memory import buffer_of
from airlight.scatter.levels import Levels
from airlight.scatter.schedule import schedule


@pytest.mark.parametrize("side", [6, 7])
def test_the_yardstick_computes_what_the_device_does(gpu, commands, owned, tmp_path, side):
    program, said = bench_kernel.compiled(tmp_path, bench_scatter.C_FILE)
    if program is None:
        pytest.skip(said)
    count = (side,) * 3
    source = np.random.default_rng(5).normal(size=(3 * side**3, 4)).astype(np.float32)
    plan = schedule("none", bench_scatter.ITERATIONS, count)
    levels = owned(Levels(gpu, count, 1.0, plan, is_blocked=False, is_varied=False))
    levels.set_air(bench_scatter.SIGMA_S, bench_scatter.SIGMA_T)
    _, track = levels.encode(commands, owned(buffer_of(gpu, "source", source)))
    commands.submit()
    ours = track.read()
    words = [str(program), "check", str(side), *bench_scatter.c_numbers()]
    done = subprocess.run(words, input=source.tobytes(), capture_output=True, check=True)
    theirs = np.frombuffer(done.stdout, np.float32)
    np.testing.assert_allclose(ours, theirs, atol=3e-6 * np.abs(theirs).max())


def test_both_take_turns(gpu):
    found = bench_scatter.measure(gpu, 2, (4,))
    (case,) = found["cases"]
    assert case["device_ms"]["runs"] == 2
    if "c_ms" in case:
        assert case["ratio_min"] == case["device_ms"]["min"] / case["c_ms"]["min"]
