"""The reference of a comparison: rendered once for a scene's content, then cached on disk."""

from __future__ import annotations

import dataclasses
import json
import math
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ... import env
from ...errors import AirlightError
from ...reference.metrics import noise_floor, scene_epsilon
from ...scene.checks import F32
from ...scene.fingerprint import fingerprint
from ...scene.image import Image
from ...scene.io.ledger import own_files
from ...scene.io.numpy_files import opened_npz
from ...scene.io.writing import keep

if TYPE_CHECKING:
    from ...scene.scene import Scene
    from ..progress import Report

FORMAT = 1  # raise it when what is cached, or what it means, changes
SPP_LIMIT = 1 << 16
SPP_AT_ONCE = 256  # each such part is cached: an interrupted comparison goes on where it was
NOT_CONTENT = ("settings", "name", "exposure_stops")
"""Fields of a scene that no reference depends on, beside those that no image does."""
NO_LAYERS = "only the whole image has a reference"


@dataclass(frozen=True, eq=False)
class Reference:
    """The truth of a comparison: `image` holds the layers, "variance" and "NAME_variance".

    `seconds` is what rendering its `spp` samples per pixel took, when it was rendered;
    `notes` what Mitsuba's image leaves out or approximates; `not_cached` warns where the cache
    could not take it, and is empty elsewhere.
    """

    image: Image
    spp: int
    seconds: float
    is_from_cache: bool
    notes: tuple[str, ...] = ()
    not_cached: str = ""

    @property
    def has_layers(self) -> bool:
        """Whether its layers are known; where not, the first of `notes` says why."""
        return "indirect" in self.image.layers

    @property
    def floor(self) -> float:
        """The relmse its own noise would give a perfect image."""
        R = self.image.radiance
        return noise_floor(self.image.layers["variance"], R, scene_epsilon(R))


def reference_for(
    scene: Scene,
    size: tuple[int, int],
    spp: int,
    *,
    noise: float | None = None,
    timeout_s: float = 3600.0,
    report: Report = lambda stage, fraction: None,
) -> Reference:
    """At least `spp` samples a pixel; more, up to 65536, until the floor (relmse) is below `noise`.

    Cached on disk under a hash of the scene; a cached one is used if it is good enough
    and else refined with new samples. Where Mitsuba cannot tell layers (`NoLayers`) the reference
    is of the whole image alone, and its `notes` say so. Raises ReferenceFailure, and
    SettingsError where AIRLIGHT_CACHE leads nowhere.
    """
    from ...reference.mitsuba import LAYERS, NoLayers

    name = scene_hash(scene, size)
    # The limit is a point in time, which all runs share.
    job = _Job(scene, size, spp, noise, time.monotonic() + timeout_s, report)
    names = tuple(layer for layer in LAYERS if layer != "transmittance")
    try:
        return _cached_or_rendered(job, names, f"{name}.npz")
    except NoLayers as reason:
        # A file of its own: with a libLLVM installed later the layers are rendered all the same.
        whole = _cached_or_rendered(job, names[:1], f"{name}-whole.npz")
        note = f"{NO_LAYERS}: {str(reason).rstrip('.')}"
        return dataclasses.replace(whole, notes=(note, *whole.notes))


@dataclass(frozen=True)
class _Job:
    """What is asked for: the arguments of `reference_for`, its time limit as a point in time."""

    scene: Scene
    size: tuple[int, int]
    spp: int
    noise: float | None
    deadline_s: float
    report: Report


def _cached_or_rendered(job: _Job, names: tuple[str, ...], file: str) -> Reference:
    """The reference of the layers `names`, from `file` in the cache as far as it goes."""
    path = env.cache_folder() / "references" / file
    # Samples add up: what the cache holds is refined by runs with other seeds until the noise is
    # low enough.
    cached = _read(path, names)
    have = cached
    while (missing := _samples_missing(have, job.spp, job.noise)) > 0:
        fresh = _render(job, names, missing, have.spp if have else 0)
        have = fresh if have is None else _merged(have, fresh)
        not_cached = _cache(have, path)
        have = dataclasses.replace(have, not_cached=not_cached)
    assert have is not None
    return dataclasses.replace(have, is_from_cache=have is cached)


def _samples_missing(have: Reference | None, spp: int, noise: float | None) -> int:
    wanted, done = spp, 0 if have is None else have.spp
    # A noise that is asked for may need more samples than were asked for.
    if noise is not None and have is not None and have.floor > noise:
        # Variance falls as 1/N; a tenth more, so that the estimate of it need not be exact.
        wanted = max(spp, math.ceil(1.1 * done * have.floor / noise))
    return max(0, min(wanted - done, SPP_LIMIT - done, SPP_AT_ONCE))


def _render(job: _Job, names: tuple[str, ...], spp: int, seed: int) -> Reference:
    from ...reference import mitsuba

    # All layers in one run, until the time that is left is over.
    images = mitsuba.render_layers(
        job.scene,
        names,
        size=job.size,
        spp=max(spp, mitsuba.MIN_SPP),
        seed=seed,
        timeout_s=max(job.deadline_s - time.monotonic(), 1.0),
        progress=lambda done: job.report("reference", done),
    )
    # Each layer with the variance of its mean, which scores take for the noise floor.
    whole = images["all"]
    layers = {"variance": whole.layers["variance"]}
    for name in names[1:]:
        layers[name] = images[name].radiance
        layers[f"{name}_variance"] = images[name].layers["variance"]
    stats = whole.stats
    return Reference(
        image=Image(whole.radiance, layers),
        spp=int(stats["spp"]),
        seconds=float(stats["seconds"]),
        is_from_cache=False,
        notes=tuple(stats.get("approximations", ())),
    )


def _merged(a: Reference, b: Reference) -> Reference:
    """Two independent estimates as one: means by samples, variances of means by their squares."""
    # Shares of the samples, by which two means become one.
    total = a.spp + b.spp
    u, v = a.spp / total, b.spp / total

    def mean(x: F32, y: F32) -> F32:
        return (u * x + v * y).astype(np.float32)

    # Means by u x + v y, variances of means by u^2 x + v^2 y.
    layers = {
        name: (u * u * x + v * v * b.image.layers[name]).astype(np.float32)
        if name.endswith("variance")
        else mean(x, b.image.layers[name])
        for name, x in a.image.layers.items()
    }
    image = Image(mean(a.image.radiance, b.image.radiance), layers)
    return Reference(image, total, a.seconds + b.seconds, False, b.notes)


def _read(path: Path, names: tuple[str, ...]) -> Reference | None:
    """What is cached at `path`; None where it is nothing, broken, or lacks the layers `names`."""
    try:
        # A broken cache is as good as none.
        with own_files(), opened_npz(path) as archive:
            about = json.loads(str(archive.array("about", kinds="U")))
            arrays = {name: archive.array(name) for name in archive.names if name != "about"}
        image = Image(arrays.pop("radiance"), arrays)
        cached = Reference(image, about["spp"], about["seconds"], True, tuple(about["notes"]))
        wanted = ("variance", *names[1:], *(f"{name}_variance" for name in names[1:]))
        is_whole = all(name in arrays for name in wanted) and np.isfinite(image.radiance).all()
        return cached if is_whole else None
    except (AirlightError, ValueError, KeyError, TypeError, RecursionError):
        return None


def _cache(reference: Reference, path: Path) -> str:
    """Write it for the next time; empty, or a warning where the cache cannot be written."""
    # What is not an array goes into one text.
    about = {"spp": reference.spp, "seconds": reference.seconds, "notes": reference.notes}
    arrays: dict[str, Any] = {"about": json.dumps(about), "radiance": reference.image.radiance}
    arrays |= reference.image.layers
    return keep(path, "the reference", lambda part: np.savez(part, **arrays))


def scene_hash(scene: Scene, size: tuple[int, int]) -> str:
    """A name for what the reference of `scene` at `size` depends on: values, not files or ids."""
    return fingerprint((FORMAT, size, scene), without=NOT_CONTENT)
