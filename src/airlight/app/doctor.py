"""`airlight doctor`: which adapter is used and why, and which extras are missing."""

from __future__ import annotations

import os
import platform
import re
import sys
from collections.abc import Mapping
from dataclasses import asdict
from importlib import metadata
from typing import Any

import click

from .. import __version__, env
from ..errors import AirlightError
from .options import adapter_option
from .outputs import json_text

_EXTRA_PURPOSE = {
    "reference": "path-traced references (Mitsuba) and comparisons",
    "view": "the viewer, in a window or a browser",
    "notebook": "the viewer in a notebook",
    "vdb": "OpenVDB files (.vdb)",
    "gltf": "glTF meshes compressed with Draco, KTX 2 images",
    "usd": "USD scenes",
    "science": "NetCDF and zarr grids",
    "denoise": "images without noise (Open Image Denoise)",
    "vtk": "the example with PyVista",
    "video": "videos of sequences",
    "farm": "sequences on several machines",
}
_NOT_LISTED = ("docs", "test", "test-view", "all")
"""Extras that nobody needs who only uses airlight, and the one that is all others."""
_REQUIREMENT = re.compile(r"^([A-Za-z0-9._-]+).*[; ]extra\s*==\s*['\"]([\w-]+)['\"]$")


@click.command("doctor")
@adapter_option()
@click.option("--json", "as_json", is_flag=True, help="For a machine to read.")
def command(adapter: str, as_json: bool) -> None:
    """Say which adapter is used, and what is missing.

    Lists the graphics adapters, why one is used, the extras, and how to get what is missing.
    """
    # All is gathered before any of it is said, so that a failure hides nothing.
    graphics, problem = graphics_facts(adapter)
    cache, no_cache = cache_facts()
    facts = {
        "airlight": __version__,
        "python": platform.python_version(),
        "system": platform.platform(),
        "cpu_cores": os.cpu_count(),
        **graphics,
        "extras": extras(),
        "llvm": llvm_facts(),
        "switches": {switch.name: env.value(switch.name) for switch in env.SWITCHES},
        "cache": cache,
    }
    click.echo(json_text(facts) if as_json else _text(facts))
    # The first problem is the exit code's, after everything was said.
    if problem := problem or no_cache:
        raise problem


def graphics_facts(wanted: str) -> tuple[dict[str, Any], AirlightError | None]:
    """Every adapter, which one `wanted` would use, why, and by which code paths; or why none."""
    from ..gpu import code_paths, device

    # A refusal is part of the answer: all adapters are listed beside the reason.
    found = device.adapters()
    listed = [asdict(info) for info in found]
    try:
        chosen = device.choose(found, wanted)
        paths = code_paths.chosen_paths(is_cpu=chosen.is_cpu).name
    except AirlightError as error:
        return {"adapters": listed, "used": None, "because": str(error), "paths": None}, error
    because = device.chosen_reason(found, chosen, wanted)
    return {"adapters": listed, "used": chosen.name, "because": because, "paths": paths}, None


def cache_facts() -> tuple[str, AirlightError | None]:
    """The cache folder, or why there is none, which is an error."""
    try:
        return str(env.cache_folder()), None
    except AirlightError as error:
        return f"none: {error}", error


def extras() -> dict[str, dict[str, Any]]:
    """For each extra: what it is for, installed versions by package (None: missing), the remedy."""
    # Sources that were not installed have no list of requirements.
    try:
        requirements = metadata.requires("airlight") or []
    except metadata.PackageNotFoundError:
        requirements = []
    found: dict[str, dict[str, Any]] = {}
    # Requirements of the package that belong to an extra, with what is installed of each.
    for match in filter(None, map(_REQUIREMENT.match, requirements)):
        package, extra = match.groups()
        if extra in _NOT_LISTED:
            continue
        entry = found.setdefault(
            extra,
            {
                "for": _EXTRA_PURPOSE.get(extra, ""),
                "packages": {},
                "get_it": f'pip install "airlight[{extra}]"',
            },
        )
        entry["packages"][package] = _installed_version(package)
    return found


def _installed_version(package: str) -> str | None:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def llvm_facts(environment: Mapping[str, str] = os.environ) -> dict[str, Any]:
    """The LLVM that Mitsuba's fast variants would load; without one it runs scalar, slower."""
    from ..reference.mitsuba_llvm import find_llvm

    library = find_llvm(environment)
    return {
        "library": None if library is None else str(library),
        "for": "faster references: Mitsuba's llvm variants; without it they run scalar",
        "get_it": _llvm_remedy(),
    }


def _llvm_remedy() -> str:
    if sys.platform == "darwin":
        return "brew install llvm, then set DRJIT_LIBLLVM_PATH to its libLLVM.dylib"
    if sys.platform == "win32":
        return "install LLVM from its releases page, then set DRJIT_LIBLLVM_PATH to LLVM-C.dll"
    return "apt install libllvm19 (16 or newer), or set DRJIT_LIBLLVM_PATH"


def _text(facts: Mapping[str, Any]) -> str:
    # The program, adapters and why one is used, extras, switches and the cache.
    lines = [
        f"airlight {facts['airlight']}, Python {facts['python']}, {facts['system']}, "
        f"{facts['cpu_cores']} CPU cores",
        "",
        "Graphics adapters",
        *(_adapter_line(info, facts["used"]) for info in facts["adapters"]),
    ]
    if not facts["adapters"]:
        lines.append("  none")
    if facts["used"] is not None:
        lines.append(f"  used: {facts['used']}; why: {facts['because']}")
        lines.append(f"  code paths: {facts['paths']}")
    else:
        lines.append(f"  none is used: {facts['because']}")
    lines += ["", "Extras", *(_extra_line(name, e) for name, e in facts["extras"].items())]
    llvm = facts["llvm"]
    state = llvm["library"] or f"missing; {llvm['get_it']}"
    lines += [f"  LLVM: {state} ({llvm['for']})", "", "Switches"]
    lines += [
        f"  {switch.name}={facts['switches'][switch.name]}  {switch.meaning}"
        for switch in env.SWITCHES
    ]
    return "\n".join([*lines, f"  cache: {facts['cache']}"])


def _adapter_line(info: Mapping[str, Any], used: str | None) -> str:
    mark = "*" if info["name"] == used else " "
    return f"  {mark} {info['name']}: {info['adapter_type']}, {info['backend']}, {info['driver']}"


def _extra_line(name: str, extra: Mapping[str, Any]) -> str:
    missing = [package for package, version in extra["packages"].items() if version is None]
    purpose = f" ({extra['for']})" if extra["for"] else ""
    if missing:
        return f"  {name}: {', '.join(missing)} missing; {extra['get_it']}{purpose}"
    versions = ", ".join(f"{package} {v}" for package, v in extra["packages"].items())
    return f"  {name}: {versions}{purpose}"
