"""The sky's light against photons that wander through the same air, and its limits."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths.atmosphere import (
    GROUND_M,
    TOP_M,
    WAVELENGTHS_NM,
    Air,
    air_phase,
    columns_out,
    densities,
    haze_phase,
    sky_parts,
    transmittance_out,
)

WAVE = 3  # 525 nm
CEILING_M = 60_000.0  # above it lies .0005 of the air


def turned(directions, cosine, angle):
    """Unit vectors (N, 3) turned by angles of `cosine` from themselves, `angle` around."""
    sine = np.sqrt(np.maximum(0.0, 1.0 - cosine**2))
    other = np.where(np.abs(directions[:, :1]) < 0.9, [[1.0, 0, 0]], [[0, 0, 1.0]])
    u = np.cross(directions, other)
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    v = np.cross(directions, u)
    out = directions * cosine[:, None]
    out += (u * np.cos(angle)[:, None] + v * np.sin(angle)[:, None]) * sine[:, None]
    return out / np.linalg.norm(out, axis=1, keepdims=True)


def phase_table(phase):
    """Cosines at evenly spaced quantiles."""
    cosine = np.linspace(-1.0, 1.0, 40_001)
    whole = np.cumsum(phase(cosine))
    return np.interp(np.linspace(0.0, 1.0, 4001), whole / whole[-1], cosine)


def photons(air: Air, elevation: float, count: int, rng) -> tuple[float, float]:
    """Shares of the sun's horizontal light that come to the ground scattered, and unscattered.

    A flat atmosphere, Woodcock tracking, light that the ground sends back included.
    """
    tables = phase_table(air_phase), phase_table(haze_phase)
    sea = air.extinction(np.eye(3))[:, WAVE]
    most = float(sea[0] + sea[1] + sea[2])
    height = np.full(count, CEILING_M)
    direction = np.tile([np.cos(elevation), -np.sin(elevation), 0.0], (count, 1))
    scattered = np.zeros(count, bool)
    diffuse = direct = 0
    while len(height):
        height = height + direction[:, 1] * rng.exponential(1.0 / most, len(height))
        down, out = height <= 0.0, height >= CEILING_M
        direct += int((down & ~scattered).sum())
        diffuse += int((down & scattered).sum())
        # The ground sends some back, by the cosine.
        back = down & (rng.random(len(height)) < air.ground)
        up = np.sqrt(rng.random(len(height)))
        around = rng.random(len(height)) * 2.0 * np.pi
        flat = np.sqrt(1.0 - up**2)
        bounced = np.stack([flat * np.cos(around), up, flat * np.sin(around)], axis=1)
        direction = np.where(back[:, None], bounced, direction)
        scattered |= back
        # In the air: nothing, absorption, or scattering by air or by haze.
        shares = densities(np.clip(height, 0.0, None)) * sea / most
        pick = rng.random(len(height))
        by_air = pick < shares[:, 0]
        by_haze = ~by_air & (pick < shares[:, 0] + shares[:, 1])
        lost = (by_haze & (rng.random(len(height)) > 0.9)) | (
            ~by_air & ~by_haze & (pick < shares.sum(axis=1))
        )
        for chosen, table in ((by_air, tables[0]), (by_haze, tables[1])):
            chosen = chosen & ~down
            cosine = np.interp(rng.random(chosen.sum()) * 4000.0, np.arange(4001), table)
            direction[chosen] = turned(
                direction[chosen], cosine, rng.random(chosen.sum()) * 2.0 * np.pi
            )
            scattered |= chosen
        height = np.where(down, 0.0, height)
        keep = (back | (~down & ~lost)) & ~out
        height, direction, scattered = height[keep], direction[keep], scattered[keep]
    return diffuse / count, direct / count


@pytest.mark.parametrize(
    ("turbidity", "ground", "elevation_deg", "near"),
    [
        (1.0, 0.2, 50.0, 0.03),
        (3.0, 0.0, 30.0, 0.09),
        (3.0, 0.8, 60.0, 0.06),
        (6.0, 0.2, 40.0, 0.15),
    ],
)
def test_the_sky_gives_the_ground_what_wandering_photons_give(
    turbidity, ground, elevation_deg, near
):
    """Diffuse light: measured apart by .07 at turbidity 3 over black ground, .04 over white, .13 at
    6; the photons' noise is .005. What haze scatters again goes on forwards in truth and evenly
    here, so that less of it comes down."""
    air, up = Air(turbidity, ground), np.radians(elevation_deg)
    diffuse, direct = photons(air, up, 60_000, np.random.default_rng(5))
    # The sky, integrated over the hemisphere by elevation and azimuth.
    rows, columns = (np.arange(24) + 0.5) / 24 * np.pi / 2, (np.arange(36) + 0.5) / 36 * np.pi
    elevation, azimuth = (a.ravel() for a in np.meshgrid(rows, columns, indexing="ij"))
    parts = sky_parts(air, elevation, azimuth, up)
    cosine = np.cos(elevation) * np.cos(azimuth) * np.cos(up) + np.sin(elevation) * np.sin(up)
    radiance = parts.air[:, WAVE] * air_phase(cosine) + parts.often[:, WAVE]
    radiance += parts.haze[:, WAVE] * haze_phase(cosine)
    cell = (np.pi / 48) * (np.pi / 36) * 2.0  # both sides of the sun
    received = (radiance * np.cos(elevation) * np.sin(elevation)).sum() * cell / np.sin(up)
    assert received == pytest.approx(diffuse, rel=near)
    sent = transmittance_out(air, np.array(0.0), np.array(np.sin(up)))[WAVE]
    assert float(sent) == pytest.approx(direct, rel=0.012)  # of 60,000, four deviations


def test_columns_straight_up_have_their_closed_forms():
    air, haze, ozone = columns_out(np.array(0.0), np.array(1.0))
    assert air == pytest.approx(8000.0, rel=6e-3)  # 40 steps
    assert haze == pytest.approx(1200.0, rel=8e-3)
    assert ozone == pytest.approx(15_000.0, rel=0.01)
    assert np.isinf(columns_out(np.array(1000.0), np.array(-0.5))).all()
    assert TOP_M > GROUND_M


def test_turbidity_is_the_share_of_haze_at_550_nm():
    def depth(turbidity: float) -> float:
        """Of air and haze straight up, between the two wavelengths around 550 nm."""
        columns = np.array([8000.0, 1200.0, 0.0])
        return float(np.interp(550.0, WAVELENGTHS_NM, Air(turbidity).extinction(columns)))

    assert depth(4.0) / depth(1.0) == pytest.approx(4.0, rel=0.02)  # 550 lies between wavelengths
    # Rayleigh scattering of the whole atmosphere at 550 nm: .097 (Bodhaine1999), ours .108.
    assert depth(1.0) == pytest.approx(0.1, rel=0.12)


@pytest.mark.parametrize("phase", [air_phase, haze_phase])
def test_phase_functions_integrate_to_one(phase):
    cosine, weights = np.polynomial.legendre.leggauss(200)
    assert 2.0 * np.pi * float(weights @ phase(cosine)) == pytest.approx(1.0, abs=1e-6)
