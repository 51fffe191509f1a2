"""How far an image is from the truth, in numbers, and how far the truth itself can be trusted.

>>> metrics = compare(image, reference)
>>> metrics.relmse, metrics.black.relmse, metrics.noise_floor, metrics.layers["indirect"].relmse
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np

from ..errors import ReferenceFailure
from ..maths.colour import luminance
from ..maths.tone import auto_exposure
from ..scene.checks import F32, F64, instance
from ..scene.image import Image
from . import metrics_display as display

__all__ = ["EqualTime", "Metrics", "compare", "equal_time", "noise_floor", "relmse"]

LAYERS = ("direct", "indirect", "one_bounce", "single_scatter", "multiple_scatter")
SCENE_EPSILON = 1e-4  # of the squared mean luminance of the reference
FIXED_EPSILON = 1e-2  # W^2 m^-4 sr^-2, as much of the literature has it


@dataclass(frozen=True, eq=False)
class Metrics(Mapping[str, Any]):
    """Scores of one image, or of one layer of it, against the reference.

    `relmse`: mean of (I - R)^2/(R^2 + epsilon) over pixels and channels, with `epsilon` = 1e-4
    of the squared mean luminance of the whole reference image, for its layers too;
    `relmse_fixed` with `epsilon_fixed` = 1e-2. A few pixels that are black in the reference and
    lit in the image can rule it; `relative_l2`, the root of sum (I - R)^2 over sum R^2, has the
    bright ones rule. `signed_error`: mean of I - R, W m^-2 sr^-1.
    `energy_ratio`: sum of I over sum of R. `psnr_db`, `ssim`, `flip`, `hdr_flip`: of the
    image on a display at `exposure_stops`. `noise_floor`, `noise_floor_l2`:
    the relmse and relative_l2 that a perfect image would score because the reference is noisy;
    what is `within_noise` says nothing about the technique. None is a score that could not be
    taken: `omitted` says why.
    `black` and `direct_only` are the scores of a black image and of direct light alone.
    """

    relmse: float
    epsilon: float
    relmse_fixed: float
    epsilon_fixed: float
    relative_l2: float | None
    signed_error: float
    energy_ratio: float | None
    psnr_db: float
    ssim: float
    flip: float | None
    hdr_flip: float | None
    exposure_stops: float
    noise_floor: float | None
    noise_floor_l2: float | None
    omitted: Mapping[str, str] = field(default_factory=dict)
    black: Metrics | None = None
    direct_only: Metrics | None = None
    layers: Mapping[str, Metrics] = field(default_factory=dict)

    @property
    def within_noise(self) -> bool:
        """Whether the error could be the reference's noise alone: below twice its floor."""
        return self.noise_floor is not None and self.relmse <= 2.0 * self.noise_floor

    def __getitem__(self, name: str) -> Any:
        if name not in self.__dataclass_fields__:
            raise KeyError(name)
        return getattr(self, name)

    def __iter__(self) -> Iterator[str]:
        return iter(self.__dataclass_fields__)

    def __len__(self) -> int:
        return len(self.__dataclass_fields__)

    def to_json(self) -> dict[str, Any]:
        """Plain dictionaries and numbers; infinite and missing scores become None."""
        plain = {name: _plain(value) for name, value in self.items()}
        return plain | {"within_noise": self.within_noise}


@dataclass(frozen=True)
class EqualTime:
    """A path tracer against a technique, on one machine in one run.

    Its error falls as `unit_error`/samples: `error_at_time` is what it has after the technique's
    `seconds`; `seconds_to_match` and `samples_to_match` what it needs for the technique's
    `error`. Errors are relmse, or squares of relative_l2. Loading and compiling are left out on
    both sides. No match is claimed (`seconds_to_match` None) for an error within the noise.
    """

    error: float
    seconds: float
    unit_error: float
    seconds_per_sample: float
    error_at_time: float
    samples_to_match: float | None
    seconds_to_match: float | None

    def to_json(self) -> dict[str, float | None]:
        """Plain numbers."""
        return cast(dict[str, float | None], _plain(dataclasses.asdict(self)))


def compare(image: Image, reference: Image, *, perceptual: bool = True) -> Metrics:
    """Score `image` and each of the radiance LAYERS that it shares with `reference`.

    The reference's variance of the mean is its layer "variance" (of a layer NAME,
    "NAME_variance"); without it there is no noise floor. `perceptual = False` leaves FLIP out.
    Raises ReferenceFailure for images of different sizes or with NaN.
    """
    instance(image, "the image", Image)
    instance(reference, "the reference", Image)
    # Every layer against its own truth, with the exposure and epsilons of the whole reference.
    judge = _Judge.of(reference, perceptual)
    judge.check(image.radiance, "image")
    layers = {
        name: judge.score_beside_black(
            image.layers[name], reference.layers[name], reference.layers.get(f"{name}_variance")
        )
        for name in LAYERS
        if name in image.layers and name in reference.layers
    }
    # The whole image, beside a black one and one of direct light alone.
    whole = judge.score_beside_black(
        image.radiance, reference.radiance, reference.layers.get("variance")
    )
    direct = reference.layers.get("direct")
    only = None if direct is None else judge.score(direct, reference.radiance, None)
    return dataclasses.replace(whole, direct_only=only, layers=layers)


def relmse(image: F32, reference: F32, epsilon: float) -> float:
    """Mean of (I - R)^2/(R^2 + epsilon); 0 where both are black and epsilon is 0."""
    R = np.asarray(reference, dtype=np.float64)
    scale, error = R * R + epsilon, _difference(image, reference) ** 2
    with np.errstate(divide="ignore", invalid="ignore"):
        return float(np.mean(np.where(error > 0.0, error / scale, 0.0)))


def noise_floor(variance: F32, reference: F32, epsilon: float) -> float:
    """The relmse that the reference's own variance of the mean would give a perfect image."""
    R = np.asarray(reference, dtype=np.float64)
    v = np.asarray(variance, dtype=np.float64)

    # A variance averaged over colours holds for each of the three.
    v = v if v.ndim == R.ndim else v[..., None]
    scale = R * R + epsilon
    return float(np.mean(np.divide(v, scale, out=np.zeros_like(R), where=scale > 0.0)))


def scene_epsilon(reference: F32) -> float:
    """1e-4 of the squared mean luminance of the reference."""
    return SCENE_EPSILON * float(np.mean(luminance(reference))) ** 2


def equal_time(
    error: float,
    seconds: float,
    *,
    floor: float,
    samples: int,
    reference_seconds: float,
) -> EqualTime:
    """The path tracer's time for a technique's `error`, and its error in `seconds`.

    `error` is anything that noise makes fall as 1/N: relmse, the square of relative_l2. The noise
    `floor` of `samples` per pixel, taken in `reference_seconds`, sets a 1/N law:
    the variance of a mean of independent samples, no fit to several runs. The technique's error
    is taken less the floor, which is the reference's. Raises ReferenceFailure for no samples.
    """
    if samples < 1 or reference_seconds <= 0.0:
        raise ReferenceFailure("equal-time figures need a reference with samples and a time")
    # What one sample would be off, and the technique's own error.
    unit, per_sample = floor * samples, reference_seconds / samples
    own = error - floor
    needed = unit / own if own > floor else None
    return EqualTime(
        error=error,
        seconds=seconds,
        unit_error=unit,
        seconds_per_sample=per_sample,
        error_at_time=unit * per_sample / seconds if seconds > 0.0 else math.inf,
        samples_to_match=needed,
        seconds_to_match=None if needed is None else needed * per_sample,
    )


@dataclass(frozen=True, eq=False)
class _Judge:
    """What all scores of one comparison share: exposure and epsilons come from the reference."""

    shape: tuple[int, ...]
    epsilon: float
    stops: float
    exposures: tuple[float, float]
    perceptual: bool

    @classmethod
    def of(cls, reference: Image, perceptual: bool) -> _Judge:
        R = reference.radiance
        _refuse_non_finite(R, "reference")

        # The exposure and the range of exposures that every image of the comparison is shown at.
        exposures = display.flip_exposures(R)
        return cls(R.shape, scene_epsilon(R), auto_exposure(R), exposures, perceptual)

    def check(self, radiance: F32, name: str) -> None:
        if radiance.shape != self.shape:
            raise ReferenceFailure(
                f"the {name} is {radiance.shape[1]}x{radiance.shape[0]}, the reference "
                f"{self.shape[1]}x{self.shape[0]}",
                remedy="Render both at one size.",
            )
        _refuse_non_finite(radiance, name)

    def score_beside_black(self, image: F32, reference: F32, variance: F32 | None) -> Metrics:
        # A black image is the score that doing nothing would get.
        own = self.score(image, reference, variance)
        return dataclasses.replace(own, black=self.score(np.zeros_like(reference), reference, None))

    def score(self, image: F32, reference: F32, variance: F32 | None) -> Metrics:
        self.check(image, "layer")
        # What cannot be computed is None, with the reason beside.
        total = float(np.sum(reference, dtype=np.float64))
        omitted = {} if total > 0.0 else {"energy_ratio": "the reference is black"}
        if variance is None:
            omitted["noise_floor"] = "the reference has no variance"
        flips = self._flips(image, reference, omitted)
        square = float(np.sum(np.square(reference, dtype=np.float64)))
        # Errors relative to each pixel and to the whole, energy, what eyes see, and the noise that
        # the reference brings itself.
        return Metrics(
            relmse=relmse(image, reference, self.epsilon),
            epsilon=self.epsilon,
            relmse_fixed=relmse(image, reference, FIXED_EPSILON),
            epsilon_fixed=FIXED_EPSILON,
            relative_l2=_root_share(_difference(image, reference) ** 2, square),
            signed_error=float(np.mean(_difference(image, reference))),
            energy_ratio=float(np.sum(image, dtype=np.float64)) / total if total > 0.0 else None,
            psnr_db=display.psnr_db(reference, image, self.stops),
            ssim=display.ssim(reference, image, self.stops),
            flip=flips[0],
            hdr_flip=flips[1],
            exposure_stops=self.stops,
            noise_floor=(
                None if variance is None else noise_floor(variance, reference, self.epsilon)
            ),
            noise_floor_l2=None if variance is None else _root_share(variance, square),
            omitted=omitted,
        )

    def _flips(
        self, image: F32, reference: F32, omitted: dict[str, str]
    ) -> tuple[float | None, float | None]:
        """FLIP and HDR-FLIP, or None and why."""
        why = "not asked for"
        if self.perceptual:
            try:
                return (
                    float(np.mean(display.flip_map(reference, image, self.stops))),
                    float(np.mean(display.hdr_flip_map(reference, image, self.exposures))),
                )
            except ImportError:
                why = "flip-evaluator is not installed: pip install 'airlight[reference]'"
        omitted.update(flip=why, hdr_flip=why)
        return None, None


def _root_share(squares: F32 | F64, of: float) -> float | None:
    """The root of sum squares / of, as broadcast to three channels; None of nothing."""
    total = float(np.sum(squares, dtype=np.float64)) * (3.0 if squares.ndim == 2 else 1.0)
    return math.sqrt(total / of) if of > 0.0 else None


def _refuse_non_finite(radiance: F32, name: str) -> None:
    bad = int(np.sum(~np.isfinite(radiance).all(axis=-1)))
    if bad:
        raise ReferenceFailure(f"{bad} pixels of the {name} are NaN or infinite")


def _difference(image: F32, reference: F32) -> F64:
    return np.asarray(image, dtype=np.float64) - np.asarray(reference, dtype=np.float64)


def _plain(value: Any) -> Any:
    if isinstance(value, Metrics):
        return value.to_json()
    if isinstance(value, Mapping):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
