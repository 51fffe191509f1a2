"""Light of black bodies against published chromaticities, luminances and Stefan-Boltzmann."""

import numpy as np
import pytest

from airlight.maths import blackbody, observer


def test_planck_radiates_as_stefan_and_boltzmann_say() -> None:
    length = np.geomspace(1e-8, 1e-2, 40001)
    for kelvin in (300.0, 1500.0, 6000.0):
        radiance = np.trapezoid(blackbody.planck(length, kelvin), length)
        assert radiance == pytest.approx(5.670374e-8 * kelvin**4 / np.pi, rel=1e-4)


@pytest.mark.parametrize(
    ("kelvin", "x", "y"),
    # The Planckian locus, Wyszecki1982, and illuminant A.
    [
        (1500, 0.5857, 0.3931),
        (2000, 0.5267, 0.4133),
        (2856, 0.4476, 0.4074),
        (6500, 0.3135, 0.3237),
    ],
)
def test_chromaticities_lie_on_the_planckian_locus(kelvin: float, x: float, y: float) -> None:
    found = blackbody.xyz(kelvin)
    np.testing.assert_allclose(found[:2] / found.sum(), (x, y), atol=3e-4)


def test_luminance_of_freezing_platinum() -> None:
    """The candela was defined by it until 1979: 60 per cm^2 at 2041.4 K."""
    assert 683.0 * blackbody.xyz(2041.4)[1] == pytest.approx(6.0e5, rel=0.01)


def test_the_table_is_the_integral() -> None:
    kelvin = np.array([0.0, 300.0, 700.0, 1234.5, 1999.0, 4000.0, 15000.0])
    found = blackbody.rec709_of_grid(kelvin)
    assert (found[:2] == 0.0).all()
    np.testing.assert_allclose(found[2:], blackbody.rec709(kelvin[2:]), rtol=1e-3, atol=1e-8)
    assert (np.diff(found[3:5]) < 0.0).any(axis=1).all()  # reddish
    assert found[6, 2] > found[6, 0]


def test_the_observer_has_equal_areas_and_published_values() -> None:
    """An equal-energy spectrum is white; y peaks at 555 nm; values of CIE 15:2004."""
    assert observer.observer(555.0)[1] == 1.0
    sums = observer.MATCHING.sum(axis=0)
    np.testing.assert_allclose(sums / sums[1], 1.0, atol=5e-4)
    np.testing.assert_allclose(observer.observer(600.0), (1.0622, 0.631, 0.0008), atol=1e-6)
    halfway = 0.5 * (observer.observer(450.0) + observer.observer(455.0))
    np.testing.assert_allclose(observer.observer(452.5), halfway)
    assert (observer.observer([200.0, 1000.0]) == 0.0).all()
