"""Columns, arcades, vaults, furniture: sizes that must fit each other."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.scene.builtin import arcade, atrium_shell, columns, furniture, relief, room_shell
from airlight.scene.builtin.rod import curtain_rod

from .conftest import make_caster


def span(geometry, axis: int) -> tuple[float, float]:
    return float(geometry.positions[:, axis].min()), float(geometry.positions[:, axis].max())


@pytest.mark.parametrize("twist", [0.0, 0.35])
def test_column_reaches_from_floor_to_arch(twist: float) -> None:
    column = columns.column(3.8, 0.26, twist_turns=twist)
    assert span(column, 1) == pytest.approx((0.0, 3.8), abs=1e-6)
    assert max(span(column, 0)[1], span(column, 2)[1]) == pytest.approx(columns.ABACUS_HALF_M)
    outwards = np.einsum("ij,ij->i", column.positions[:, [0, 2]], column.normals[:, [0, 2]])
    assert (outwards > -1e-3).mean() > 0.97


def test_flutes_are_cut_into_the_shaft() -> None:
    shaft = columns.column(3.8, 0.26).positions
    waist = shaft[np.abs(shaft[:, 1] - 1.8) < 0.5]
    radius = np.hypot(waist[:, 0], waist[:, 2])
    assert 0.84 < radius.min() / radius.max() < 0.96


def test_abacus_carries_the_arch() -> None:
    assert arcade.BAY_M / 2 - columns.ABACUS_HALF_M < arcade.ARCH_RADIUS_M
    assert columns.ABACUS_HALF_M > arcade.WALL_HALF_M


def test_arch_is_open_and_its_wall_closed() -> None:
    cast = make_caster(arcade.arch_wall().positions[arcade.arch_wall().indices].astype(float))
    points = np.array([(0.0, 4.5), (0.6, 4.3), (0.0, 4.8), (-1.0, 4.5), (1.15, 3.9), (0.3, 5.7)])
    origins = np.concatenate([points, np.full((6, 1), 2.0)], axis=1)
    hit = np.isfinite(cast(origins, np.tile((0.0, 0.0, -1.0), (6, 1))))
    assert hit.tolist() == [False, False, True, True, True, True]


def test_vault_is_the_higher_of_two_barrels() -> None:
    vault = arcade.groin_vault(1.2, 1.85)
    x, y, z = vault.positions.T.astype(float)
    barrels = [np.sqrt(np.clip(1 - (q / half) ** 2, 0, 1)) for q, half in ((x, 1.2), (z, 1.85))]
    assert np.allclose(y, columns.SPRING_M + arcade.VAULT_RISE_M * np.maximum(*barrels), atol=1e-5)
    p = vault.positions[vault.indices].astype(float)
    flat = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])[:, 1] / 2
    assert np.all(flat < 0.0) and -flat.sum() == pytest.approx(4 * 1.2 * 1.85, rel=1e-5)


def test_ribs_cover_the_joints_of_the_vaults() -> None:
    rib = arcade.transverse_rib(0.19)
    low, high = span(rib, 2)
    assert low < arcade.OUTER_WALL_Z and high > -arcade.WALL_HALF_M
    assert span(rib, 0) == pytest.approx((-0.19, 0.19))


def test_balustrade_fits_between_pedestals() -> None:
    low, high = span(arcade.balustrade(), 0)
    assert high - low < arcade.BAY_M - 2 * 0.2 and high > arcade.BAY_M / 2 - 0.36
    assert span(columns.pedestal(0.36), 1) == pytest.approx((0.0, columns.PEDESTAL_M))
    assert span(columns.pilaster(0.19, 0.1), 1)[1] == pytest.approx(columns.SPRING_M, abs=2e-3)
    assert span(columns.pier(0.45, 5.8), 1) == pytest.approx((0.0, 5.8))


def test_mouldings_run_around_the_court() -> None:
    for course in (atrium_shell.string_course(), atrium_shell.cornice()):
        assert np.abs(course.positions[:, 0]).min() < 0.2
        assert span(course, 2)[1] <= atrium_shell.COURT_Z_M + 0.43
    assert span(atrium_shell.cornice(), 1)[1] == pytest.approx(atrium_shell.PARAPET_M, abs=1e-5)
    assert span(atrium_shell.skirting(), 1) == pytest.approx((0.0, 0.5))


def test_the_lion_stands_out_of_its_shield_evenly() -> None:
    shield = relief.lion_shield()
    assert span(shield, 2)[0] >= -1e-6 and 0.2 < span(shield, 2)[1] < 0.6
    assert np.hypot(*shield.positions[:, :2].T).max() == pytest.approx(0.95, abs=1e-3)


def test_fountain_holds_its_water() -> None:
    stone, water = columns.fountain()
    assert span(water, 1)[1] < span(stone, 1)[1] and span(water, 0)[1] < span(stone, 0)[1]


def test_rod_lies_along_x() -> None:
    low, high = span(curtain_rod(2.0, 0.3), 0)
    assert -low == pytest.approx(high) and 1.0 < high < 1.15


def test_furniture_stands_on_the_floor() -> None:
    upholstery, feet = furniture.sofa()
    for piece in (feet, furniture.table(), furniture.chair(), furniture.shelf(), furniture.vase()):
        assert span(piece, 1)[0] == pytest.approx(0.0, abs=1e-6)
    assert span(upholstery, 1)[0] == pytest.approx(span(feet, 1)[1])
    assert span(furniture.lamp_shade(), 1)[1] == pytest.approx(0.0, abs=1e-6)
    frame, canvas = furniture.picture_frame(0.9, 0.6)
    assert span(canvas, 2)[1] < span(frame, 2)[1]


def test_books_stand_between_boards() -> None:
    piles = furniture.books(np.random.default_rng(0), 5)
    assert len(piles) == 5
    heights = np.array(furniture.shelf_heights()) + furniture.BOARD_M
    for pile in piles:
        feet = pile.positions[pile.normals[:, 1] < -0.9][:, 1]
        assert np.abs(feet[:, None] - heights).min(axis=1).max() < 1e-5
        assert span(pile, 0)[0] > -0.6 and span(pile, 0)[1] < 0.6


def test_window_frame_fills_its_hole() -> None:
    low, high = span(room_shell.window_frame(), 1)
    assert (low, high) == pytest.approx(room_shell.WINDOW_Y_M, abs=1e-6)
