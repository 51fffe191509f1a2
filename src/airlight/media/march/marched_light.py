"""What rays through media gather, and which form of the marching kernel reads it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ...fields import HalfSpaceLight, LatticeSource, Source
from .kernel import MAX_LEVELS_AT_ONCE, LatticeForm, SkyForm, Variant

_TWO_BANDS = 0.25  # the largest g that two bands are enough for


@dataclass(frozen=True, eq=False)
class MarchedLight:
    """What rays gather: solved emission, and lattices of mean radiance, which media scatter.

    `sky`: the environment's light scattered once. `half_space`: of an endless medium, beyond the
    lattices.
    """

    sources: Sequence[Source] = ()
    lattice: LatticeSource | None = None
    sky: LatticeSource | None = None
    half_space: HalfSpaceLight | None = None


def variant_of(light: MarchedLight, sharpest: float) -> Variant:
    """What marches `light` in media whose largest |g| is `sharpest`.

    Loops and reads that lattices and media do not need are left out: they would cost.
    """
    # Sky and lattice have the same nested levels, so either says how many.
    one = light.sky or light.lattice
    return Variant(
        len(light.sources),
        fading_of(light.sources),
        _lattice_form(light.lattice, sharpest),
        _sky_form(light.sky, sharpest),
        has_forward=light.lattice is not None and light.lattice.forward is not None,
        levels=min(len(one.levels), MAX_LEVELS_AT_ONCE) if one else 1,
        half_space_side=light.half_space.side if light.half_space else 0,
        is_reduced_medium=light.lattice is not None and light.lattice.is_reduced_medium,
    )


def fading_of(sources: Sequence[Source]) -> tuple[bool, ...]:
    """Which sources are finer grids inside the next one; () if none is."""
    fading = tuple(s.fade is not None for s in sources)
    return fading if any(fading) else ()


def _lattice_form(lattice: LatticeSource | None, sharpest: float) -> LatticeForm:
    """`sharpest`: the largest |g| of all media."""
    # What the lattice was solved for decides, then how sharply media scatter.
    if lattice is None:
        return "none"
    if lattice.inscattered:
        return "in-scattering"
    if lattice.is_reduced_medium:
        return "reduced medium"
    return "mean" if sharpest == 0.0 and lattice.mean is not None else "two bands"


def _sky_form(sky: LatticeSource | None, sharpest: float) -> SkyForm:
    if sky is None:
        return "none"
    # Two bands do not hold the lobe of a large g; the mean is enough for isotropic media.
    if sharpest > _TWO_BANDS and sky.third is not None:
        return "three bands"
    return "mean" if sharpest == 0.0 and sky.mean is not None else "two bands"
