"""Sun and sky in numbers that others measured: illuminance, luminance, colour."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths.atmosphere import Air
from airlight.maths.colour import REC709_LUMINANCE
from airlight.maths.latlong import latlong_row_solid_angles, latlong_texel_directions
from airlight.maths.sunlight import (
    EFFICACY_LM_PER_W,
    colour_matching,
    rgb_of_sunlight,
    sky_map,
    sun_irradiance,
    sun_spectrum,
)

XYZ_FROM_RGB = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750],
     [0.0193339, 0.1191920, 0.9503041]]
)  # fmt: skip


def towards(elevation_deg: float) -> np.ndarray:
    e = np.radians(elevation_deg)
    return np.array([0.0, np.sin(e), -np.cos(e)])


def sky_lux(turbidity: float, elevation_deg: float) -> float:
    """What the sky alone gives the ground."""
    sky = sky_map(Air(turbidity), towards(elevation_deg), 64)[:32]
    weights = (
        latlong_texel_directions(64, 128)[:32, :, 1] * latlong_row_solid_angles(64, 128)[:32, None]
    )
    return float((sky * weights[..., None]).sum(axis=(0, 1)) @ REC709_LUMINANCE) * EFFICACY_LM_PER_W


def test_the_sun_outside_the_air():
    """Illuminance 128,000 lux (IESNA: 127,500), colour near that of the solar spectrum."""
    fine = np.arange(360.0, 781.0)
    xyz = sun_spectrum(fine) @ colour_matching(fine) * 683.0
    assert xyz[1] == pytest.approx(127_500.0, rel=0.03)
    assert xyz[:2] / xyz.sum() == pytest.approx((0.3233, 0.3327), abs=0.005)
    # The eight wavelengths stand for the whole.
    rgb = rgb_of_sunlight().sum(axis=0) * EFFICACY_LM_PER_W
    assert XYZ_FROM_RGB @ rgb == pytest.approx(xyz, rel=1e-3)


def test_dusk_dims_as_the_almanac_says():
    """Clear sky with the sun at 0, -3 and -6 degrees: some 700, 70 and 3.4 lux (Seidelmann1992)."""
    assert sky_lux(2.5, 0.0) == pytest.approx(700.0, rel=0.25)
    assert sky_lux(2.5, -3.0) == pytest.approx(70.0, rel=0.6)
    assert sky_lux(2.5, -6.0) == pytest.approx(3.4, rel=0.5)


def test_day_is_as_bright_as_it_is():
    """Perpendicular sunlight at 60 degrees 90 to 105 klx, a clear sky 10 to 20 klx (IESNA)."""
    sun = float(sun_irradiance(Air(2.0), 60.0) @ REC709_LUMINANCE) * EFFICACY_LM_PER_W
    assert 90e3 < sun < 105e3
    assert 10e3 < sky_lux(2.0, 60.0) < 20e3
    zenith = sky_map(Air(2.0), towards(30.0), 64)[0].mean(axis=0)
    # 1 to 3 kcd m^-2, and bluer than 10,000 K: x below .28.
    xyz = XYZ_FROM_RGB @ zenith * EFFICACY_LM_PER_W
    assert 1e3 < xyz[1] < 3e3
    assert xyz[0] / xyz.sum() < 0.28


def test_the_sun_reddens_and_sets():
    high, low = sun_irradiance(Air(3.0), 60.0), sun_irradiance(Air(3.0), 5.0)
    assert high[2] / high[0] > 0.55 > 0.2 > low[2] / low[0]
    assert sun_irradiance(Air(3.0), 0.0).sum() < sun_irradiance(Air(3.0), 0.2).sum()
    assert sun_irradiance(Air(3.0), -0.3).sum() == 0.0


def test_haze_brightens_the_horizon_and_dims_the_sun():
    clear, hazy = (sky_map(Air(t), towards(40.0), 64) for t in (1.5, 6.0))
    # Beside the sun and high up; at the horizon haze also hides the sky behind it.
    assert hazy[16, 32].sum() > 1.3 * clear[16, 32].sum()
    assert sun_irradiance(Air(6.0), 40.0).sum() < 0.7 * sun_irradiance(Air(1.5), 40.0).sum()


def test_the_ground_sends_back_its_share():
    made = sky_map(Air(3.0, ground=0.3), towards(50.0), 64)
    sky, weights = made[:32], latlong_texel_directions(64, 128)[:32, :, 1]
    solid_angles = latlong_row_solid_angles(64, 128)[:32, None]
    received = (sky * (weights * solid_angles)[..., None]).sum(axis=(0, 1))
    received += sun_irradiance(Air(3.0), 50.0) * np.sin(np.radians(50.0))
    assert made[40, 7] == pytest.approx(0.3 / np.pi * received, rel=1e-6)


@pytest.mark.needs("mitsuba")
@pytest.mark.parametrize(("elevation_deg", "near"), [(20.0, 0.2), (40.0, 0.15), (70.0, 0.2)])
def test_the_sky_gives_what_mitsubas_gives(elevation_deg, near):
    """Mitsuba's `sunsky` (Hosek2012) at turbidity 2: measured -5, +8, +15 %. Its radiance is for
    each nanometre; of its green the eye takes 683 lm W^-1 over 106.9 nm."""
    import mitsuba

    mitsuba.set_variant("scalar_rgb")
    x, y, z = towards(elevation_deg)
    emitter = {
        "type": "sunsky", "turbidity": 2.0, "albedo": 0.2, "sun_scale": 0.0,
        "sun_direction": [float(x), float(-z), float(y)],
    }  # fmt: skip
    scene = mitsuba.load_dict(
        {"type": "scene", "sky": emitter, "ball": {"type": "sphere", "radius": 0.001}}
    )
    directions = latlong_texel_directions(24, 48)[:12]
    solid_angles = latlong_row_solid_angles(24, 48)[:12]
    received = np.zeros(3)
    for row, solid_angle in zip(directions, solid_angles, strict=True):
        for d in row:
            seen = mitsuba.SurfaceInteraction3f()
            seen.wi = mitsuba.Vector3f(-float(d[0]), float(d[2]), -float(d[1]))
            radiance = np.array(scene.environment().eval(seen, True)).ravel()
            received += radiance * float(d[1]) * solid_angle
    theirs = float(received @ REC709_LUMINANCE) * 683.0 * 106.857
    assert sky_lux(2.0, elevation_deg) == pytest.approx(theirs, rel=near)
