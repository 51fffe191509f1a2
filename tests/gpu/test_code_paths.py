"""Which code paths a device takes: a switch of its own, beside the adapter."""

from __future__ import annotations

import pytest

from airlight.errors import SettingsError
from airlight.gpu import device
from airlight.gpu.code_paths import CPU_PATHS, GPU_PATHS, chosen_paths
from airlight.gpu.device import Gpu, open_gpu


@pytest.mark.parametrize(
    ("wanted", "is_cpu", "expected"),
    [
        ("auto", True, "cpu"),
        ("auto", False, "gpu"),
        ("gpu", True, "gpu"),
        ("CPU", False, "cpu"),
    ],
)
def test_choice(wanted, is_cpu, expected, monkeypatch):
    assert chosen_paths(wanted, is_cpu=is_cpu).name == expected
    monkeypatch.setenv("AIRLIGHT_PATHS", wanted)
    assert chosen_paths(is_cpu=is_cpu).name == expected


def test_other_words_are_refused(monkeypatch):
    with pytest.raises(SettingsError, match=r"^paths: there are no paths 'fast'\. Use auto"):
        chosen_paths("fast", is_cpu=True)
    monkeypatch.setenv("AIRLIGHT_PATHS", "fast")
    with pytest.raises(SettingsError, match=r"^AIRLIGHT_PATHS: there are no paths 'fast'"):
        open_gpu()


def test_a_process_has_a_device_for_each(gpu, monkeypatch):
    both = [open_gpu(gpu.info.name, paths) for paths in ("gpu", "cpu")]
    assert [made.paths for made in both] == [GPU_PATHS, CPU_PATHS]
    assert both[0] is not both[1]
    assert both[0].info == both[1].info == gpu.info
    assert gpu in both
    monkeypatch.setenv("AIRLIGHT_PATHS", "gpu")
    assert open_gpu(gpu.info.name) is both[0]


@pytest.mark.both_paths
def test_a_test_of_both_paths_has_each(gpu, paths):
    assert gpu.paths.name == paths
    assert open_gpu(gpu.info.name) is gpu  # what a Renderer of the test opens


def test_a_device_without_the_limits_of_the_cpu_paths_takes_them_all_the_same(gpu):
    card = device.AdapterInfo("Card", "DiscreteGPU", "Vulkan", "", "", gpu.info.index)
    plain = Gpu(card, CPU_PATHS, "default")
    assert plain.paths.stored_uniforms and not plain.has_uniforms_in_storage
    assert Gpu(card, GPU_PATHS).paths is GPU_PATHS
