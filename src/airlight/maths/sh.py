"""Real spherical harmonics of bands 0 to 2, and intensity in two bands as a + b.w.

Order (l, m): (0,0) | (1,-1) y, (1,0) z, (1,1) x | (2,-2) xy, (2,-1) yz, (2,0) 3z^2-1, (2,1) xz,
(2,2) x^2-y^2. All signs positive (no Condon-Shortley phase). Two-band intensities of the
lattices are kept as (a, bx, by, bz) with I(w) = a + b.w, W/sr.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

F64 = NDArray[np.float64]

Y0 = float(np.sqrt(1.0 / (4.0 * np.pi)))
Y1 = float(np.sqrt(3.0 / (4.0 * np.pi)))
Y2_XY = float(np.sqrt(15.0 / (4.0 * np.pi)))
Y2_Z = float(np.sqrt(5.0 / (16.0 * np.pi)))
Y2_X = float(np.sqrt(15.0 / (16.0 * np.pi)))

# Convolution of band l with the clamped cosine: pi, 2 pi/3, pi/4.
# Source: Ramamoorthi and Hanrahan 2001, eq. 8.
COSINE_BANDS: F64 = np.pi * np.repeat([1.0, 2.0 / 3.0, 1.0 / 4.0], [1, 3, 5])


def sh_basis(direction: ArrayLike) -> F64:
    """The nine basis functions (..., 9) at unit directions (..., 3)."""
    d = np.asarray(direction, dtype=np.float64)
    x, y, z = d[..., 0], d[..., 1], d[..., 2]
    bands = [
        np.full_like(x, Y0),
        Y1 * y,
        Y1 * z,
        Y1 * x,
        Y2_XY * x * y,
        Y2_XY * y * z,
        Y2_Z * (3.0 * z * z - 1.0),
        Y2_XY * x * z,
        Y2_X * (x * x - y * y),
    ]
    return np.stack(bands, axis=-1)


def sh_evaluate(coefficients: ArrayLike, direction: ArrayLike) -> F64:
    """The function of coefficients (K,) or (K, C), K = 1, 4 or 9, at unit directions (..., 3).

    Gives (...) or (..., C).
    """
    c = np.asarray(coefficients, dtype=np.float64)
    return np.asarray(sh_basis(direction)[..., : c.shape[0]] @ c)


def clamped_cosine_sh(normal: ArrayLike) -> F64:
    """Coefficients (..., 9) of max(0, n.w) for unit normals (..., 3).

    Source: Ramamoorthi and Hanrahan 2001, eqs. 7-8.
    """
    return COSINE_BANDS * sh_basis(normal)


def irradiance_from_radiance_sh(coefficients: ArrayLike, normal: ArrayLike) -> F64:
    """Irradiance, W m^-2, on unit normals (..., 3) under radiance SH (9,) or (9, C).

    The radiance arrives *from* the direction it is stored at, as an environment does; not
    clamped. Source: Ramamoorthi and Hanrahan 2001, eq. 5.
    """
    c = np.asarray(coefficients, dtype=np.float64)
    return np.asarray(clamped_cosine_sh(normal) @ c)


def intensity_from_sh(coefficients: ArrayLike) -> F64:
    """(a, bx, by, bz) of two-band coefficients (..., 4) in the order of this module."""
    c = np.asarray(coefficients, dtype=np.float64)
    return np.stack([Y0 * c[..., 0], Y1 * c[..., 3], Y1 * c[..., 1], Y1 * c[..., 2]], axis=-1)


def sh_from_intensity(intensity: ArrayLike) -> F64:
    """Two-band coefficients (..., 4) of (a, bx, by, bz)."""
    i = np.asarray(intensity, dtype=np.float64)
    return np.stack([i[..., 0] / Y0, i[..., 2] / Y1, i[..., 3] / Y1, i[..., 1] / Y1], axis=-1)


def cosine_lobe(normal: ArrayLike, power_w: ArrayLike) -> F64:
    """(a, bx, by, bz) of a clamped cosine lobe of total power `power_w` about unit normals.

    Shapes (..., 3) and (...) to (..., 4). a = P/4pi, b = P n/2pi: its two-band projection.
    Source: Kaplanyan2010 section 3.1, through clamped_cosine_sh.
    """
    n, p = np.asarray(normal, dtype=np.float64), np.asarray(power_w, dtype=np.float64)
    a = np.broadcast_to(p / (4.0 * np.pi), n.shape[:-1])
    return np.concatenate([a[..., None], p[..., None] * n / (2.0 * np.pi)], axis=-1)


def intensity(state: ArrayLike, direction: ArrayLike) -> F64:
    """I(w) = a + b.w, W/sr, of (..., 4) states at directions (..., 3); not clamped."""
    s, d = np.asarray(state, dtype=np.float64), np.asarray(direction, dtype=np.float64)
    return np.asarray(s[..., 0] + np.einsum("...i,...i->...", s[..., 1:], d))


def environment_sh(radiance: ArrayLike, rotation_deg: float = 0.0) -> F64:
    """Radiance SH (9, C) of a latitude-longitude map (H, W, C), W m^-2 sr^-1.

    Orientation as in scene.Environment: u = atan2(x, -z)/2pi, v = acos(y)/pi from the top row;
    `rotation_deg` turns the map counter-clockwise seen from +Y. Each texel's box is integrated
    exactly, so that the smallest maps and their poles are right.
    """
    texels = np.asarray(radiance)
    polar = _polar_integrals(texels.shape[0])
    around = _azimuth_integrals(texels.shape[1], np.deg2rad(rotation_deg))
    rows = {k: np.einsum("hwc,w->hc", texels, f) for k, f in around.items()}

    def over(theta: str, phi: str) -> F64:
        return np.asarray(polar[theta] @ rows[phi], dtype=np.float64)

    # x = sin(theta) sin(phi), y = cos(theta), z = -sin(theta) cos(phi).
    zz = 0.5 * (over("ss", "1") + over("ss", "c2"))
    xx = 0.5 * (over("ss", "1") - over("ss", "c2"))
    bands = [
        Y0 * over("1", "1"),
        Y1 * over("c", "1"),
        -Y1 * over("s", "c1"),
        Y1 * over("s", "s1"),
        Y2_XY * over("sc", "s1"),
        -Y2_XY * over("sc", "c1"),
        Y2_Z * (3.0 * zz - over("1", "1")),
        -0.5 * Y2_XY * over("ss", "s2"),
        Y2_X * (xx - over("cc", "1")),
    ]
    return np.stack(bands)


def _polar_integrals(height: int) -> dict[str, F64]:
    """Per row the integrals of 1, c, s, sc, ss, cc (c = cos, s = sin) times sin over theta."""
    theta = np.linspace(0.0, np.pi, height + 1)
    c, s = np.cos(theta), np.sin(theta)
    antiderivatives = {
        "1": -c,
        "c": s * s / 2.0,
        "s": theta / 2.0 - s * c / 2.0,
        "sc": s**3 / 3.0,
        "ss": -c + c**3 / 3.0,
        "cc": -(c**3) / 3.0,
    }
    return {name: np.diff(f) for name, f in antiderivatives.items()}


def _azimuth_integrals(width: int, rotation: float) -> dict[str, F64]:
    """Per column the integrals of 1, cos, sin, cos 2, sin 2 over the azimuth."""
    phi = np.linspace(0.0, 2.0 * np.pi, width + 1) - rotation
    antiderivatives = {
        "1": phi,
        "c1": np.sin(phi),
        "s1": -np.cos(phi),
        "c2": np.sin(2.0 * phi) / 2.0,
        "s2": -np.cos(2.0 * phi) / 2.0,
    }
    return {name: np.diff(f) for name, f in antiderivatives.items()}
