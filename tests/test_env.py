"""Switches: one table, unset means default, caches where the system keeps them."""

from __future__ import annotations

from pathlib import Path

import pytest

from airlight import env


def test_unset_and_empty_mean_the_default():
    assert env.value("AIRLIGHT_ADAPTER", {}) == "auto"
    assert env.value("AIRLIGHT_ADAPTER", {"AIRLIGHT_ADAPTER": ""}) == "auto"
    assert env.value("AIRLIGHT_ADAPTER", {"AIRLIGHT_ADAPTER": "cpu"}) == "cpu"


def test_an_unknown_switch_is_a_mistake_of_ours():
    with pytest.raises(KeyError):
        env.value("AIRLIGHT_TYPO", {})


@pytest.mark.parametrize(
    ("text", "expected"), [("1", True), ("YES", True), ("0", False), ("", False)]
)
def test_truth(text, expected):
    assert env.is_on("AIRLIGHT_DEBUG", {"AIRLIGHT_DEBUG": text}) is expected


@pytest.mark.parametrize(
    ("environment", "platform", "expected"),
    [
        ({"AIRLIGHT_CACHE": "/tmp/x", "XDG_CACHE_HOME": "/c"}, "linux", Path("/tmp/x")),
        ({"XDG_CACHE_HOME": "/c"}, "linux", Path("/c/airlight")),
        ({}, "linux", Path.home() / ".cache" / "airlight"),
        ({}, "darwin", Path.home() / "Library" / "Caches" / "airlight"),
        ({"LOCALAPPDATA": "/l"}, "win32", Path("/l/airlight/cache")),
    ],
)
def test_the_cache_is_where_the_system_keeps_caches(environment, platform, expected):
    assert env.cache_folder(environment, platform) == expected


def test_every_switch_says_what_it_does():
    for switch in env.SWITCHES:
        assert switch.name.startswith("AIRLIGHT_")
        assert switch.meaning
