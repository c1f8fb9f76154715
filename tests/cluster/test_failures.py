"""Frames, parts of pictures, pictures of sweeps that fail on every worker: named, others kept."""

from __future__ import annotations

import re

import dask
import numpy as np
import pytest
from PIL import Image

import distal
from distal.cluster import WorkerPool, tasks
from distal.cluster.errors import FailedTaskError, TaskError
from distal.diagnostics import DeviceError
from distal.lang import Frame, image, slider, vec3
from distal.video import video
from tests.cluster.conftest import local_cluster

SIZE = (48, 32)
FPS = 10
AMOUNT = slider("Amount", 0.0, 0.0, 100.0)


@image
def stuck(frame: Frame) -> vec3:
    """Never ends at one time."""
    total, i = 0.0, 0
    while i < 10 or abs(frame.time - 2.5) < 0.01:
        total += 0.001 * float(i % 7)
        i = (i + 1) % 1000000 + 10 * (i // 1000000)
    return vec3(total + frame.coord.x / 48.0, frame.time * 0.1, AMOUNT * 0.01)


def film(path, **options):
    """Four seconds: the segments are of two seconds, and frame 25 never ends."""
    told = []
    given = {"duration": 4, "fps": FPS, "size": SIZE, "quality": "lossless", **options}
    return video(stuck, path, tell=told.append, **given), told


def kept(folder):
    return sorted(p.name for p in folder.iterdir() if p.suffix in (".png", ".mp4"))


# What a worker does when it starts, again after each of its ends.
WILD = """
import os
from distal.cluster import work
if not hasattr(work, "real"):  # Dask runs this twice
    work.real = work._options
    def wild(options, stop):
        if 40 < options["params"].get("amount", 0) < 60:
            options = {**options, "size": "wild"}
        if options["index"] == 7:
            os._exit(1)
        return work.real(options, stop)
    work._options = wild
"""
WHY = "failed on a worker: "


@pytest.fixture(scope="module")
def wild():
    """Workers that frame 7 ends, and that fail where the amount is near 50."""
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 1}),
        local_cluster(2, preload=[WILD]) as found,
    ):
        yield found


def test_a_frame_that_takes_too_long_is_named(client, tmp_path):
    path, pool = tmp_path / "film.mp4", WorkerPool(client, timeout=2.0)
    for expected in (39, 0):  # the second time only the failed frame is tried
        done = []
        with pytest.raises(DeviceError) as caught:
            film(path, cluster=pool, progress=lambda *at, done=done: done.append(at))
        assert str(caught.value) == (
            "frame 25 at 2.5 s took more than 2 s; the other frames are kept: the same command "
            "renders only what failed"
        )
        pictures = [f"frame-{i:05d}.png" for i in range(20, 40) if i != 25]
        assert kept(tmp_path / ".film.mp4.distal") == ["000000-000019.mp4", *pictures]
        assert not path.exists()
        assert {i for i, _, _ in done} >= ({1, 19, 39} if expected else {39})


def test_a_part_of_a_picture_that_takes_too_long(client):
    with pytest.raises(TaskError) as caught:
        stuck.render((32, 400), time=2.5, cluster=WorkerPool(client, timeout=1.0))
    found = r"the part of the picture from row \d+ to \d+ took more than 1 s"
    assert re.fullmatch(found, str(caught.value))


def test_an_error_with_many_frames_arrives(client):
    """Dask would not deliver it, and the client would wait without end."""
    with pytest.raises(FailedTaskError, match=r"^maximum recursion depth exceeded"):
        client.submit(deep, pure=False).result(timeout=30)


def deep():
    def deeper(number):
        return deeper(number + 1)

    return tasks.run({"version": distal.__version__, "limit_s": 1.0}, lambda stop: deeper(0))


def test_a_frame_that_ends_each_worker(wild, tmp_path):
    """The others are not concerned, also those that were on the same workers."""
    with pytest.raises(DeviceError) as caught:
        film(tmp_path / "film.mp4", duration=1.6, cluster=wild)
    assert re.fullmatch(
        r"frame 7 at 0\.7 s ended each of the 2 workers that tried it, at last tcp://127\.0\.0\.1:"
        r"\d+; the other frames are kept: the same command renders only what failed",
        str(caught.value),
    )
    pictures = [f"frame-{i:05d}.png" for i in range(16) if i != 7]
    assert kept(tmp_path / ".film.mp4.distal") == pictures
    made, told = film(tmp_path / "film.mp4", duration=1.6)
    assert made.rendered == 1 and told == ["continues: 15 of 16 frames are there"]
    film(tmp_path / "whole.mp4", duration=1.6)
    assert (tmp_path / "film.mp4").read_bytes() == (tmp_path / "whole.mp4").read_bytes()


def test_when_all_frames_fail_the_first_ones_end_the_film(wild, tmp_path):
    with pytest.raises(DeviceError) as caught:
        film(tmp_path / "%02d.png", cluster=wild, params={"Amount": 50.0}, size=(8, 8), start=0.8)
    assert kept(tmp_path) == []
    start = "8 of 40 frames failed: 0 at 0.8 s, 1 at 0.9 s, 2 at 1 s, 3 at 1.1 s, 4 at 1.2 s"
    assert str(caught.value).startswith(start) and WHY in str(caught.value)
    assert str(caught.value).endswith("; the last 8 in a row, so the others were not tried")


def test_a_folder_of_a_sweep_without_some(wild, tmp_path):
    values = {"time": "0,1", "amount": "0,50,5"}
    with pytest.raises(DeviceError) as caught:
        distal.sweep(stuck, values, tmp_path / "all", size=SIZE, cluster=wild)
    start = f"2 of 6 pictures failed: time 0, Amount 50; time 1, Amount 50; the first {WHY}"
    assert str(caught.value).startswith(start)
    end = "; the other pictures are kept: the same command renders only what failed"
    assert str(caught.value).endswith(end)
    assert kept(tmp_path / "all") == ["001.png", "003.png", "004.png", "006.png"]
    assert len((tmp_path / "all" / "sweep.csv").read_text().splitlines()) == 5
    made = distal.sweep(stuck, values, tmp_path / "all", size=SIZE)
    assert made.rendered == 2 and len(made.rows) == 6


def test_a_sheet_of_a_sweep_without_one(wild, tmp_path):
    with pytest.raises(DeviceError, match=r"^1 of 3 pictures failed: Amount 50; it failed"):
        distal.sweep(stuck, {"Amount": "0,50,5"}, tmp_path / "s.png", size=SIZE, cluster=wild)
    assert np.asarray(Image.open(tmp_path / "s.png")).shape[1] > 3 * SIZE[0]
    rows = (tmp_path / "s.csv").read_text().splitlines()
    # The picture that failed has no row: the next run makes it.
    assert [row.split(",")[0] for row in rows] == ["number", "1", "3"]
