"""Several lattices in one table, as shaders see them."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.lattice.placement import LatticeParams, Placement
from airlight.lattice.table import LatticeTable

ROWS = [Placement((float(k), 2.0, 3.0), 2.0**k, (4, 6, 8), first_row=6 * k) for k in range(3)]


def test_lattices_lie_in_the_table_in_their_order(gpu, owned):
    table = owned(LatticeTable(gpu, 3))
    read = table.filled([p.params(5.0) for p in ROWS]).read(np.uint8).view(LatticeParams.dtype)
    np.testing.assert_array_equal(read["cell"], [1.0, 2.0, 4.0])
    np.testing.assert_array_equal(read["first_row"], [0, 6, 12])
    np.testing.assert_array_equal(read["origin"][:, 0], [0.0, 1.0, 2.0])
    np.testing.assert_array_equal(read["power_scale"], 5.0)


def test_the_table_follows_what_changes(gpu, owned):
    table = owned(LatticeTable(gpu, 1))
    for power in (1.0, 8.0, 8.0):
        read = table.filled([ROWS[0].params(power)]).read(np.uint8).view(LatticeParams.dtype)
        assert read["power_scale"][0] == power


def test_as_many_as_the_table_is_long(gpu, owned):
    table = owned(LatticeTable(gpu, 2))
    with pytest.raises(ValueError, match="3 lattices in a table of 2"):
        table.filled([p.params() for p in ROWS])
