"""Every AIRLIGHT_* environment variable, in one table. `airlight doctor` shows it."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from .errors import SettingsError


@dataclass(frozen=True)
class Switch:
    """One environment variable, what it stands at when unset, and what it does."""

    name: str
    default: str
    meaning: str


SWITCHES: tuple[Switch, ...] = (
    Switch("AIRLIGHT_ADAPTER", "auto", "graphics adapter: auto, cpu, gpu or a part of its name"),
    Switch("AIRLIGHT_CACHE", "", "folder for what is costly to make again; empty: the system's"),
    Switch(
        "AIRLIGHT_ROOT",
        "",
        "folder that scene files may name files in, no others; empty: any of the machine",
    ),
    Switch("AIRLIGHT_PATHS", "auto", "code paths: auto (made for the adapter), gpu or cpu"),
    Switch(
        "AIRLIGHT_LIMITS", "auto", "of devices: auto, or default for WebGPU's, without features"
    ),
    Switch("AIRLIGHT_DEBUG", "0", "1 prints the tracebacks behind an error"),
)


def value(name: str, environment: Mapping[str, str] = os.environ) -> str:
    """What a switch stands at. An empty variable counts as unset. KeyError for an unknown name."""
    switch = {switch.name: switch for switch in SWITCHES}[name]
    return environment.get(name, "") or switch.default


def is_on(name: str, environment: Mapping[str, str] = os.environ) -> bool:
    """Whether a switch stands at 1, true, yes or on."""
    return value(name, environment).lower() in ("1", "true", "yes", "on")


def cache_folder(environment: Mapping[str, str] = os.environ, platform: str = sys.platform) -> Path:
    """AIRLIGHT_CACHE, else airlight's folder where the system keeps caches; not created here.

    Raises SettingsError where the home folder that it is in cannot be found.
    """
    # An explicit folder wins over the system's.
    chosen = value("AIRLIGHT_CACHE", environment)
    try:
        return Path(chosen).expanduser() if chosen else _system_caches(environment, platform)
    except RuntimeError:  # no such user, or one without a home
        raise SettingsError(
            f"there is no home folder for the cache{f' {chosen!r}' if chosen else ''}",
            where="AIRLIGHT_CACHE",
            remedy="Set it to a folder's whole path.",
        ) from None


def _system_caches(environment: Mapping[str, str], platform: str) -> Path:
    """airlight's folder where the system keeps caches."""
    # Each system has a folder for what may be deleted.
    if platform == "darwin":
        return Path.home() / "Library" / "Caches" / "airlight"
    if platform == "win32":
        local = environment.get("LOCALAPPDATA")
        return (Path(local) if local else Path.home() / "AppData" / "Local") / "airlight" / "cache"
    xdg = environment.get("XDG_CACHE_HOME")
    return (Path(xdg) if xdg else Path.home() / ".cache") / "airlight"
