"""Lanes are asked for once, and only where a CPU adapter has them."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from airlight.gpu.code_paths import CPU_PATHS, GPU_PATHS
from airlight.gpu.device import open_gpu
from airlight.gpu.lanes import has_row_lanes


@pytest.mark.parametrize(
    ("taken", "features"),
    [
        (GPU_PATHS, ["subgroup", "shader-int64"]),
        (CPU_PATHS, ["subgroup"]),
        (CPU_PATHS, ["shader-int64"]),
    ],
)
def test_gpus_and_drivers_without_the_features_are_not_asked(taken, features):
    class Device(SimpleNamespace):
        __hash__ = object.__hash__

    assert not has_row_lanes(Device(paths=taken, features=features))


def test_mesas_cpu_adapter_has_them(gpu):
    if "256 bits" not in gpu.info.name:
        pytest.skip("not Mesa's driver with eight lanes")
    assert has_row_lanes(open_gpu(gpu.info.name, "cpu"))
