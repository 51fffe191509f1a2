"""Switches: one table, unset means default, caches where the system keeps them."""

from __future__ import annotations

from pathlib import Path

import pytest

from airlight import env
from airlight.errors import SettingsError


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


def test_a_cache_in_the_home_of_nobody_is_one_message():
    with pytest.raises(SettingsError) as caught:
        env.cache_folder({"AIRLIGHT_CACHE": "~no-such-user/x"}, "linux")
    assert str(caught.value) == (
        "AIRLIGHT_CACHE: there is no home folder for the cache '~no-such-user/x'. "
        "Set it to a folder's whole path."
    )


def test_a_user_without_a_home_is_told_what_to_set(monkeypatch):
    def homeless():
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(Path, "home", homeless)
    with pytest.raises(SettingsError, match=r"no home folder for the cache\. Set it to a folder"):
        env.cache_folder({}, "linux")
