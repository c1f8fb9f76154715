"""Parts of a picture cover it once, and their size follows the time they take."""

from __future__ import annotations

import numpy as np
import pytest

from distal.devices.tiles import TARGET_S, Tile, TileSizer, tiles


def run(width: int, height: int, tile_sizer: TileSizer, seconds_per_pixel: float) -> list[Tile]:
    parts = []
    for tile in tiles(width, height, tile_sizer):
        parts.append(tile)
        tile_sizer.measured(tile, tile.pixels * seconds_per_pixel)
    return parts


@pytest.mark.parametrize("extent", [(1, 1), (17, 5), (1, 129), (5000, 3), (640, 480), (33, 33)])
@pytest.mark.parametrize("most", [8, 64, 1000, 10**9])
def test_every_pixel_is_in_one_part(extent: tuple[int, int], most: int) -> None:
    if extent[0] * extent[1] > 20_000 and most < 1000:
        extent = (extent[0] // 10, extent[1] // 10)
    covered = np.zeros(extent[::-1], int)
    for tile in run(*extent, TileSizer(most), 1e-6):
        assert tile.pixels <= most
        covered[tile.y : tile.y + tile.height, tile.x : tile.x + tile.width] += 1
    assert (covered == 1).all()


@pytest.mark.parametrize("pixel_s", [1e-9, 1e-7, 1e-5, 2e-4])
def test_no_part_is_expected_to_take_long(pixel_s: float) -> None:
    tile_sizer = TileSizer(10**8)
    sizes = [tile.pixels * pixel_s for tile in run(1600, 1000, tile_sizer, pixel_s)]
    assert max(sizes[2:], default=0.0) <= TARGET_S * 1.01
    # Once the pace is known, few parts are needed.
    later = run(1600, 1000, tile_sizer, pixel_s)
    whole = 1600 * 1000 * pixel_s
    assert len(later) == 1 if whole < 0.1 else len(later) <= 2.5 * whole / TARGET_S


def test_a_small_picture_is_one_part_once_its_time_is_known() -> None:
    tile_sizer = TileSizer(10**8)
    assert len(run(640, 480, tile_sizer, 5e-8)) > 1
    assert run(640, 480, tile_sizer, 5e-8) == [Tile(0, 0, 640, 480)]


def test_a_sudden_slow_part_makes_the_next_one_small() -> None:
    tile_sizer = TileSizer(10**8)
    run(1000, 1000, tile_sizer, 1e-6)
    budget = tile_sizer.start(10**6)
    tile_sizer.measured(Tile(0, 0, budget, 1), 1.0)
    assert tile_sizer.next() <= budget * TARGET_S * 1.01


@pytest.mark.parametrize("pixel_s", [1e-7, 1e-5])
def test_parts_are_smaller_where_pixels_have_several_samples(pixel_s: float) -> None:
    tile_sizer = TileSizer(10**8)
    run(1600, 1000, tile_sizer, pixel_s)
    before = run(1600, 1000, tile_sizer, pixel_s)
    times = []
    for tile in tiles(1600, 1000, tile_sizer, samples=16):
        times.append(tile.pixels * pixel_s * 16)
        tile_sizer.measured(tile, times[-1])
    assert max(times) <= TARGET_S * 1.01
    assert len(times) <= 2.5 * sum(times) / TARGET_S
    # What was learned is valid for any number of samples.
    after = run(1600, 1000, tile_sizer, pixel_s)
    assert len(after) == pytest.approx(len(before), rel=0.1)


def test_the_drivers_compilation_counts_for_nothing() -> None:
    tile_sizer = TileSizer(10**8)
    first = tile_sizer.start(10**6)
    tile_sizer.measured(Tile(0, 0, first, 1), 2.0)
    assert tile_sizer.next() == first
