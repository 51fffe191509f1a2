"""A density grid, or a shape of constant density, that scales a medium's extinction."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ..errors import SceneError
from . import checks
from .checks import F32, F64, Bounds, Rgb
from .coefficients import as_grids, coefficient_grid, density_and_tint, parts_of
from .emission import Emission
from .medium import mean_cosine

if TYPE_CHECKING:
    from .enclosed import Body, Placed

IDENTITY: F64 = np.eye(4)


@dataclass(frozen=True, eq=False)
class Volume:
    """A heterogeneous medium: extinction sigma_t * density at each point.

    `density` is (z, y, x) float32, dimensionless, >= 0, voxel-centred and trilinear over
    `bounds` (metres); or None with `shape` "box" or "sphere" filling `bounds` with density 1.
    `sigma_t` is per metre at density 1. `world_from_volume` is a rigid or affine 4x4 matrix
    applied after `bounds`. `detail` is the amplitude of procedural noise added at march time.
    `emission` is the light that it gives off itself; its grid, if any, is as large as the density.

    Coefficients may differ from voxel to voxel (Elek2014 section 4), in grids as large as the
    density, (z, y, x) or (z, y, x, 3): `tint` and `albedo_grid`, in [0, 1], are multiplied with
    sigma_t and `albedo`; `g_grid`, in (-1, 1), takes the place of `g`, which is its mean. A density
    with three channels is taken apart into one and a tint. `of_coefficients` takes any of them.
    `source`: the file that the grid came from, if any. `body`: the closed surface, before
    `world_from_volume`, whose inside the density is, of `in_meshes`. `part_of` is airlight's own:
    the volume that this is one colour of.
    Raises SceneError.
    """

    sigma_t: Rgb
    density: F32 | None = None
    shape: Literal["grid", "box", "sphere"] = "grid"
    bounds: Bounds = ((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0))
    albedo: Rgb = (1.0, 1.0, 1.0)
    g: Rgb = (0.0, 0.0, 0.0)
    world_from_volume: F64 = field(default_factory=lambda: IDENTITY)
    detail: float = 0.0
    source: str = ""
    emission: Emission | None = None
    tint: F32 | None = None
    albedo_grid: F32 | None = None
    g_grid: F32 | None = None
    body: Body | None = None
    part_of: object = None

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "sigma_t", checks.rgb(self.sigma_t, "sigma_t"))
        put(self, "albedo", checks.rgb(self.albedo, "albedo", high=1.0))
        put(self, "g", mean_cosine(self.g))
        put(self, "bounds", checks.bounds(self.bounds, "volume bounds"))
        put(self, "detail", checks.number(self.detail, "detail", low=0.0, high=10.0))
        put(self, "world_from_volume", checks.affine(self.world_from_volume, "volume transform"))
        # A grid of densities or a shape of density 1, never both.
        if self.shape not in ("grid", "box", "sphere"):
            raise SceneError(f"volume shape '{self.shape}' is unknown", remedy="Use box or sphere.")
        if (self.density is None) == (self.shape == "grid"):
            raise SceneError("a volume needs either a density grid or a shape (box, sphere)")
        if self.density is None and self.detail > 0.0:
            raise SceneError("detail makes a density grid finer, a shape has none")
        if self.density is not None:
            density, tint = _checked_density(self.density)
            put(self, "density", density)
            # Colours of the density join those of the tint, as both multiply the extinction.
            if tint is not None:
                put(self, "tint", tint if self.tint is None else tint * self.tint)
        self._check_coefficients()
        self._check_emission()

    def _check_coefficients(self) -> None:
        put = object.__setattr__
        # Of the three only g may be negative.
        for name, low in (("tint", 0.0), ("albedo_grid", 0.0), ("g_grid", -0.9999)):
            values = getattr(self, name)
            if values is None:
                continue
            if self.density is None:
                raise SceneError(
                    f"a shape has no voxels that its {name} could belong to",
                    remedy="Give it a density grid.",
                )
            shape, high = self.density.shape, 0.9999 if low else 1.0
            # The product with the volume's albedo has to stay below 1.
            if name == "albedo_grid":
                high /= max(*self.albedo, 1e-6)
            put(self, name, coefficient_grid(values, f"volume {name}", shape, low=low, high=high))
        if self.g_grid is not None and self.density is not None:
            # The mean over what scatters: a phase function counts where light is scattered.
            weights = self.density.astype(np.float64)[..., None] + 1e-30
            for shares in (self.tint, self.albedo_grid):
                weights = weights if shares is None else weights * shares
            weights = np.broadcast_to(weights, self.g_grid.shape)
            sums = (self.g_grid * weights).sum(axis=(0, 1, 2))
            r, g, b = sums / np.maximum(weights.sum(axis=(0, 1, 2)), 1e-300)
            put(self, "g", (float(r), float(g), float(b)))

    def _check_emission(self) -> None:
        size = self.emission.size if self.emission else None
        # An emission without a grid is in proportion to the density, or the same everywhere.
        if size is None:
            return
        if self.density is None:
            raise SceneError(
                "a shape has no voxels that an emission grid could light",
                remedy="Give it a density grid, or an emission alone.",
            )
        if size != self.density.shape:
            have, want = (" x ".join(map(str, s[::-1])) for s in (size, self.density.shape))
            raise SceneError(f"volume emission has {have} voxels, its density has {want}")

    @classmethod
    def of_coefficients(
        cls,
        *,
        sigma_s: Any = None,
        sigma_a: Any = None,
        sigma_t: Any = None,
        albedo: Any = None,
        g: Any = 0.0,
        **others: Any,
    ) -> Volume:
        """A volume of sigma_s and sigma_a, or of sigma_t and albedo, m^-1, and g.

        Each is a number, a colour, or a grid (z, y, x) or (z, y, x, 3); one at least is a grid.
        `others`: bounds, world_from_volume, detail, emission. Raises SceneError.
        """
        given = {"sigma_s": sigma_s, "sigma_a": sigma_a, "sigma_t": sigma_t, "albedo": albedo}
        return cls(**as_grids({**given, "g": g}), **others)

    @classmethod
    def in_meshes(cls, meshes: Sequence[Placed], *, sigma_t: Any, **others: Any) -> Volume:
        """A volume of density 1 in what closed meshes enclose together, where they stand.

        `sigma_t` is its extinction coefficient, m^-1, a number or a colour.
        Each mesh has a `geometry` and a `world_from_object`, as a `Mesh` has; holes are closed by
        plane lids. Where all triangles face one way the inside is what they wind around, else what
        an odd number of surfaces lies before. It is made of up to 128 voxels a side, of which those
        that the surface cuts are partly dense. `others`: albedo, g, emission, detail. Raises
        SceneError for meshes that enclose nothing.
        """
        from .enclosed import Body

        of_density_1 = checks.rgb(sigma_t, "sigma_t")
        body = Body.of(meshes) if meshes else None
        found = body.density(1.0 / max(*of_density_1, 1e-30)) if body else None
        if found is None:
            raise SceneError(
                "the meshes enclose nothing that a medium could fill",
                remedy="A surface has to close around it; check it for holes.",
            )
        return cls(of_density_1, found[0], bounds=found[1], body=body, **others)

    @cached_property
    def parts(self) -> tuple[Volume, ...]:
        """Volumes of constant coefficients that add up to this one; see `scene.coefficients`."""
        return parts_of(self)

    @property
    def has_coefficient_grids(self) -> bool:
        """Whether coefficients other than the density differ from voxel to voxel."""
        return not (self.tint is None and self.albedo_grid is None and self.g_grid is None)

    @property
    def is_emissive(self) -> bool:
        """Whether it gives off light itself, at this time or another."""
        return self.emission is not None and max(self.emission.radiance) > 0.0


def _checked_density(density: F32) -> tuple[F32, F32 | None]:
    """The density, and the tint of one that has colours."""
    grid = checks.grid(density, "volume density")
    if grid.ndim == 4:
        return density_and_tint(grid)
    # A volume made from another keeps its very array: it need not be uploaded again.
    is_shared = isinstance(density, np.ndarray) and np.shares_memory(density, grid)
    return density if is_shared and not density.flags.writeable else grid, None
