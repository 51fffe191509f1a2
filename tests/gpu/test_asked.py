"""What is asked of a device: every limit by name, or nothing but the defaults."""

from __future__ import annotations

import pytest

from airlight.errors import SettingsError
from airlight.gpu.asked import (
    DEFAULT_LIMITS,
    FEATURES,
    asked_features,
    asked_limits,
    chosen_asked,
    has_uniforms_in_storage,
)
from airlight.gpu.code_paths import CPU_PATHS, GPU_PATHS
from airlight.gpu.device import open_gpu


@pytest.mark.parametrize(("word", "asked"), [("auto", "auto"), ("Default", "default")])
def test_the_word_is_the_callers_or_the_switchs(monkeypatch, word, asked):
    assert chosen_asked(word) == asked
    monkeypatch.setenv("AIRLIGHT_LIMITS", word)
    assert chosen_asked() == asked


def test_another_word_is_refused(monkeypatch):
    monkeypatch.setenv("AIRLIGHT_LIMITS", "most")
    with pytest.raises(SettingsError, match="AIRLIGHT_LIMITS: there are no limits 'most'"):
        chosen_asked()


def test_features_are_those_that_are_there_and_none_by_default():
    assert asked_features("auto", ["subgroup", "shader-f64"]) == ["subgroup"]
    assert asked_features("default", FEATURES) == []


@pytest.mark.parametrize("taken", [GPU_PATHS, CPU_PATHS])
def test_no_more_than_the_adapter_has_is_asked_for(taken):
    there = {name: value // 2 for name, value in DEFAULT_LIMITS.items()}
    assert asked_limits("auto", taken, there) == there
    assert asked_limits("default", taken, {"max-buffer-size": 1 << 40}) == {
        "max-buffer-size": DEFAULT_LIMITS["max-buffer-size"]
    }


def test_a_device_of_the_defaults_has_them_and_no_feature(gpu):
    plain = open_gpu(gpu.info.name, "gpu", "default")
    assert plain is open_gpu(gpu.info.name, "gpu", "default") is not gpu
    assert plain.features == []
    assert {name: plain.limits[name] for name in DEFAULT_LIMITS} == DEFAULT_LIMITS


def test_parameters_are_in_storage_where_the_device_binds_so_many(gpu):
    cpu = open_gpu(gpu.info.name, "cpu", "default")
    assert cpu.paths.stored_uniforms and not cpu.has_uniforms_in_storage
    assert not has_uniforms_in_storage(DEFAULT_LIMITS)
    more = {name: 64 for name in DEFAULT_LIMITS}
    assert has_uniforms_in_storage(more)
