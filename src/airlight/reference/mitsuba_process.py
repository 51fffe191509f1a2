"""The child process that renders: `python -m airlight.reference.mitsuba_process JOB.json`.

Mitsuba can abort or hang; then only this process is lost. It reads a Job, prints lines
    ready VARIANT        Mitsuba has started and compiled a first kernel
    progress 0.25        share of all samples done
and writes the result file whole. It ends when its standard input closes, which the parent's
death does too.
"""

from __future__ import annotations

import json
import os
import shutil
import sys
import threading
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

SCALAR_VARIANT = "scalar_rgb"  # interpreted: our Python plugins would take forever in it
MAX_SAMPLES_A_PASS = 1 << 22  # camera rays in flight: bounds memory in compiled variants


@dataclass(frozen=True)
class Job:
    """What to render: `layers` of mitsuba_paths, or "all" alone for Mitsuba's own integrator.

    `max_depth`: as in Mitsuba, -1 for no limit. `spp` is split over at least four independent
    renders, from which the variance is estimated.
    """

    xml: str
    result: str
    variant: str
    layers: tuple[str, ...]
    integrator: str
    width: int
    height: int
    spp: int
    seed: int
    max_depth: int = -1
    hide_environment: bool = False
    has_area_lights: bool = False
    has_media: bool = True
    has_masks: bool = True

    def write(self, path: Path) -> None:
        """Leave it as JSON."""
        path.write_text(json.dumps(asdict(self)))


def read_job(path: Path) -> Job:
    """The job that `Job.write` left."""
    fields = json.loads(path.read_text())
    return Job(**{**fields, "layers": tuple(fields["layers"])})


def main(job_file: str) -> None:
    """Render the job and leave its result file."""
    job = read_job(Path(job_file))
    threading.Thread(target=_end_with_parent, args=(Path(job_file).parent,), daemon=True).start()

    # Mitsuba takes seconds to import: the thread that ends with the parent runs before.
    import mitsuba as mi

    mi.set_variant(job.variant)
    mi.set_log_level(mi.LogLevel.Error)
    _check_compiler(job.variant)
    # Our own reflection models are Python, which would take forever where it is interpreted.
    if job.variant != SCALAR_VARIANT:
        from . import mitsuba_glass
        from .mitsuba_brdf import register

        register()
        mitsuba_glass.register()
    _say(f"ready {job.variant}")
    start = time.perf_counter()
    sums = _Batches(job)
    sums.run()
    # The result appears whole: a parent that looks sees all of it or none.
    result = Path(job.result)
    partial = result.with_suffix(".part.npz")
    arrays: dict[str, Any] = {"spp": sums.spp, "seconds": time.perf_counter() - start}
    arrays["left_out"] = sums.left_out
    arrays.update(sums.results())
    np.savez(partial, **arrays)
    partial.replace(result)


def _end_with_parent(folder: Path) -> None:
    """Nobody waits for the image any more: leave, and leave nothing behind."""
    while os.read(0, 64):  # not sys.stdin: its lock would outlive the interpreter
        pass
    shutil.rmtree(folder, ignore_errors=True)
    os._exit(3)


def _check_compiler(variant: str) -> None:
    """Compile something: an LLVM that does not work ends the process here, not later."""
    if variant.startswith("llvm"):
        import drjit as dr
        import mitsuba as mi

        dr.eval(dr.arange(mi.Float, 16) * 2.0)


def _say(line: str) -> None:
    print(line, flush=True)


class _Batches:
    """Independent renders and their running mean and variance, per layer."""

    def __init__(self, job: Job) -> None:
        self.job = job
        pixels = job.width * job.height

        # Four batches at least, each of as many samples as memory holds rays for.
        batch_spp = max(1, min(job.spp // 4, MAX_SAMPLES_A_PASS // pixels))
        self.count = max(4, round(job.spp / batch_spp))
        self.batch_spp = max(1, round(job.spp / self.count))
        self.spp = self.count * self.batch_spp
        # Batches of each pixel (H, W, 1), without those in which a sample was no number.
        self._taken: NDArray[np.float64] = np.zeros((job.height, job.width, 1))
        self._mean: dict[str, NDArray[np.float64]] = {}
        self._m2: dict[str, NDArray[np.float64]] = {}

    @property
    def left_out(self) -> int:
        """How many pixels lack a batch, and have others."""
        return int(((self._taken > 0) & (self._taken < self.count)).sum())

    def run(self) -> None:
        renderer = _layered if self.job.integrator == "airlight_layers" else _Stock(self.job)
        for index in range(self.count):
            # Jobs of neighbouring seeds share no seed of a batch.
            seed = (self.job.seed * 1_000_003 + index) % 2**32
            self._add(renderer(self.job, seed, self.batch_spp))
            _say(f"progress {(index + 1) / self.count:.4f}")

    def _add(self, images: dict[str, NDArray[np.float32]]) -> None:
        """Welford's running moments, of the pixels whose samples are all numbers."""
        parts = np.stack([np.isfinite(x).all(axis=-1, keepdims=True) for x in images.values()])
        is_whole = parts.all(axis=0)
        self._taken += is_whole
        n = np.maximum(self._taken, 1.0)
        for name, image in images.items():
            mean = self._mean.setdefault(name, np.zeros(image.shape))
            m2 = self._m2.setdefault(name, np.zeros(image.shape))
            x = np.where(is_whole, image, mean).astype(np.float64)
            delta = x - mean
            mean += delta / n
            m2 += delta * (x - mean)

    def results(self) -> dict[str, NDArray[np.float32]]:
        """NAME and NAME.variance (of the mean), float32, per layer."""
        # The variance of the mean: squared deviations over n (n - 1). Pixels without a number stay
        # so.
        scale = 1.0 / np.maximum((self._taken - 1.0) * self._taken, 1.0)
        has_any = self._taken > 0
        means = {
            name: np.where(has_any, mean, np.nan).astype(np.float32)
            for name, mean in self._mean.items()
        }
        spread = {f"{n}.variance": (m2 * scale).astype(np.float32) for n, m2 in self._m2.items()}
        return means | spread


def _load(job: Job, xml: str) -> Any:
    import mitsuba as mi

    return mi.load_file(xml, width=job.width, height=job.height, max_depth=job.max_depth)


_SCENES: dict[str, Any] = {}


def _layered(job: Job, seed: int, spp: int) -> dict[str, NDArray[np.float32]]:
    """One pass of the integrator that tells layers apart."""
    import mitsuba as mi

    from . import mitsuba_paths

    # Loading compiles for seconds, so scene and integrator serve all batches.
    if "layered" not in _SCENES:
        mitsuba_paths.register()
        description = {
            "type": "airlight_layers",
            "max_depth": job.max_depth,
            "hide_environment": job.hide_environment,
            "has_media": job.has_media,
            "has_masks": job.has_masks,
        }
        _SCENES["layered"] = (_load(job, job.xml), mi.load_dict(description))
    scene, integrator = _SCENES["layered"]
    image = np.array(mi.render(scene, integrator=integrator, seed=seed, spp=spp))
    # The integrator's channels: the image, then each layer's three.
    parts = {"all": image[..., :3]}
    for index, name in enumerate(mitsuba_paths.PATH_LAYERS):
        parts[name] = image[..., 3 + 3 * index : 6 + 3 * index]
    return {name: parts[name] for name in job.layers}


# A layer is the image of the first length limit minus that of the second.
_LIMITS = {"all": (-1,), "direct": (2,), "one_bounce": (3, 2), "indirect": (-1, 2)}


class _Stock:
    """Mitsuba's own integrators; layers are differences between path length limits.

    All limits use one seed: in compiled variants the paths are then the same, and the noise
    of what they share cancels.
    """

    def __init__(self, job: Job) -> None:
        import mitsuba as mi

        self._scene = _load(job, job.xml)
        self._integrators: dict[int, Any] = {}

        # Hiding all emitters would hide area lights too: there the environment is subtracted.
        self._subtract = job.hide_environment and job.has_area_lights
        self._hide = job.hide_environment and not job.has_area_lights
        self._background = _load(job, _environment_only(job.xml)) if self._subtract else None
        self._mi = mi

    def __call__(self, job: Job, seed: int, spp: int) -> dict[str, NDArray[np.float32]]:
        rendered: dict[int, NDArray[np.float32]] = {}

        def limited(limit: int) -> NDArray[np.float32]:
            # A limit that the job itself sets holds for both ends of a difference.
            if job.max_depth > 0:
                limit = job.max_depth if limit < 0 else min(limit, job.max_depth)
            if limit not in rendered:
                rendered[limit] = self._render(self._scene, job.integrator, limit, seed, spp)
                if self._background is not None:
                    rendered[limit] -= self._render(self._background, job.integrator, 1, seed, spp)
            return rendered[limit]

        # A layer is the difference of two limits on path length; limits that layers share are
        # rendered once.
        parts = {}
        for name in job.layers:
            first, *rest = _LIMITS[name]
            parts[name] = limited(first) - (limited(rest[0]) if rest else np.float32(0.0))
        return parts

    def _render(
        self, scene: Any, kind: str, limit: int, seed: int, spp: int
    ) -> NDArray[np.float32]:
        if limit not in self._integrators:
            description = {"type": kind, "max_depth": limit, "hide_emitters": self._hide}
            self._integrators[limit] = self._mi.load_dict(description)
        integrator = self._integrators[limit]
        image = self._mi.render(scene, integrator=integrator, seed=seed, spp=spp)
        return np.array(image, dtype=np.float32)[..., :3]


def _environment_only(xml: str) -> str:
    """The scene with every other light removed: what a hidden environment must lose."""
    from xml.etree import ElementTree

    tree = ElementTree.parse(xml)
    for parent in list(tree.iter()):
        for emitter in parent.findall("emitter"):
            if emitter.get("type") not in ("constant", "envmap"):
                parent.remove(emitter)
    path = Path(xml).with_name("environment_only.xml")
    tree.write(path)
    return str(path)


if __name__ == "__main__":
    main(sys.argv[1])
