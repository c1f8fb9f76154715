"""Pictures of a cluster are those of one process, bit for bit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import distal
from distal import Box, Scene, Sphere
from distal.cluster import ClusterError, WorkerPool, pool_of, whole_pictures, work
from distal.cluster import pool as pools
from distal.cluster.errors import TaskError
from distal.devices.base import Cancelled
from distal.images.picture import Picture, Provenance
from distal.lang import Frame, Texture2D, fract, image, sample, slider, vec3
from distal.lang.render_options import RenderOptions
from distal.lang.runtime_access import executor

ROWS = np.random.default_rng(1).random((7, 5, 4)).astype(np.float32)
TEXTURE = Texture2D(ROWS)
GLOW = slider("Glow", 0.4, 0.0, 1.0)


@image
def tinted(frame: Frame) -> vec3:
    """A texture, a parameter, the time and the frame's numbers."""
    at = frame.coord / frame.resolution
    color = sample(TEXTURE, at * 2.0).xyz
    return fract(color + vec3(GLOW, frame.time, float(frame.index) * 0.1 + at.x))


def equal(obj, client, size=(70, 50), **options):
    """Check that all that is known of two pictures is the same."""
    alone = obj.render(size, **options)
    together = obj.render(size, cluster=client, **options)
    np.testing.assert_array_equal(together.array, alone.array)
    assert together.metadata == alone.metadata
    if alone.light is not None:
        np.testing.assert_array_equal(together.linear, alone.linear)
    return together


@pytest.mark.parametrize("size", [(1, 1), (65, 17), (200, 130), (16, 300)])
def test_an_image_of_any_size(client, size):
    equal(tinted, client, size, time=1.25, params={"Glow": 0.7}, index=3)


def test_samples_of_an_image(client):
    equal(tinted, client, samples=4)


@pytest.mark.parametrize("name", ["castle", "bricks", "lithophane"])
def test_scenes_with_tables_and_data(client, name):
    """Adaptive samples, parts that move, buffers, textures."""
    equal(distal.load(f"example:{name}"), client, (96, 64), time=0.8, mode="direct")


def test_frozen_numbers_layers_and_views(client):
    scene = Scene(Box(1.0).paint("#c44") - Sphere(0.6))
    equal(scene, client, freeze=True)
    equal(scene, client, view="normal")
    equal(scene, client, samples=3, transparent=True)
    made = equal(scene, client, layers=("depth", "material"))
    assert set(made.layers) == {"depth", "material"}


def test_paths_and_photons(client):
    scene = distal.load("example:caustics")
    equal(scene, client, (48, 32), mode="path", spp=8)


def test_other_numbers_take_the_same_program(client):
    """A slider moves numbers alone: nothing is sent or compiled again."""
    scene = Scene(Sphere(slider("Size", 0.5, 0.1, 1.0)))
    pool = WorkerPool(client)
    for size in (0.3, 0.8):
        equal(scene, pool, params={"Size": size})
        kept = len(pool._sent)
    assert len(pool._sent) == kept


def test_whole_pictures(client):
    pool = WorkerPool(client)
    pictures = [tinted, distal.load("example:bricks").program("color", None, encoded=True)[0]]
    for each in pictures:
        options = RenderOptions(size=(80, 60), time=0.5)
        [made] = whole_pictures.pictures(pool, each, [options], exact=True)
        alone = executor().render(each, options)
        np.testing.assert_array_equal(made.array, alone.array)
        assert made.metadata == alone.metadata
        [levels] = [p.array for p in whole_pictures.pictures(pool, each, [options])]
        assert levels.dtype == np.float32
        np.testing.assert_array_equal(np.rint(levels * 255.0), levels * 255.0)


def break_third():
    """Let the picture with index 2 fail on a worker, after the others of its task are begun."""

    def picture(image, options, call):
        if options.index == 2:
            raise ValueError("the third")
        return work.picture(image, options, call)

    work.picture, work._picture = work._picture, picture


def repair():
    work._picture = work.picture


def test_whole_pictures_of_one_task(client):
    """Quick frames share a task; those that fail there are rendered alone, and say why."""
    pool = WorkerPool(client)
    options = [RenderOptions(size=(80, 60), time=0.1 * i, index=i) for i in range(3)]
    assert whole_pictures.of_task(pool, tinted, options[0], 40) == 1  # nothing is known
    alone = [whole_pictures.pictures(pool, tinted, [each])[0].levels for each in options]
    assert whole_pictures.of_task(pool, tinted, options[0], 4) == 1  # each worker gets one
    made = whole_pictures.pictures(pool, tinted, options)
    for picture, levels in zip(made, alone, strict=True):
        np.testing.assert_array_equal(picture.levels, levels)
    client.run(break_third)
    try:
        *made, failed = whole_pictures.pictures(pool, tinted, options)
    finally:
        client.run(repair)
    for picture, levels in zip(made, alone[:2], strict=True):
        np.testing.assert_array_equal(picture.levels, levels)
    assert isinstance(failed, TaskError)
    assert str(failed).startswith("the picture at 0.2 s failed on a worker: ")
    assert "the third" in str(failed)
    wrong = [replace(each, params={"nobody": 1.0}) for each in options]
    for failed, each in zip(whole_pictures.pictures(pool, tinted, wrong), wrong, strict=True):
        assert isinstance(failed, TaskError)
        assert str(failed).startswith(f"the picture at {each.time:g} s failed on a worker: ")


def test_progress_and_cancel(client):
    seen = []
    tinted.render((300, 200), cluster=client, progress=seen.append)
    assert seen == sorted(seen) and seen[-1] == 1.0 and len(seen) >= 3
    with pytest.raises(Cancelled):
        tinted.render((300, 200), cluster=client, cancel=lambda: True)


def test_another_version_is_refused(client, monkeypatch):
    monkeypatch.setattr(pools, "__version__", "9.9")
    with pytest.raises(ClusterError) as caught:
        tinted.render((8, 8), cluster=WorkerPool(client))
    worker = next(iter(client.nthreads()))
    assert str(caught.value).startswith("the worker tcp://127.0.0.1:")
    assert f"has distal {distal.__version__}, this process 9.9" in str(caught.value)
    assert worker.startswith("tcp://127.0.0.1:")


def test_other_processors_are_told_once(client):
    told = []
    pool = WorkerPool(client, tell=told.append)
    pool._own_level = "sse2"
    for _ in range(2):
        tinted.render((8, 8), cluster=pool)
    assert len(told) == 1
    assert "this machine with sse2: the last bits of pixels may differ" in told[0]


def test_devices_of_workers_and_wrong_clusters(client):
    with pytest.raises(ValueError, match="workers render on their CPU, not on 'reference'"):
        tinted.render((8, 8), cluster=client, device="reference")
    with pytest.raises(TypeError, match=r"cluster is a dask.distributed.Client, not str"):
        tinted.render((8, 8), cluster="local")
    assert pool_of(client) is pool_of(client)


def test_mistakes_of_a_scene_are_told_here(client):
    @image
    def wrong(frame: Frame) -> vec3:
        return frame.coord

    with pytest.raises(distal.CompileError, match="wrong"):
        wrong.render((8, 8), cluster=client)


def test_pictures_of_levels():
    """A film's frames return as levels: the encoder gets them as they are, once rounded."""
    levels = np.arange(1024, dtype=np.uint8).reshape(16, 16, 4)
    made = Picture.of_levels(levels, Provenance(), {}).with_provenance(view="color")
    assert made.levels is levels
    np.testing.assert_array_equal(made.array, levels.astype(np.float32) / np.float32(255.0))
    np.testing.assert_array_equal(Picture(made.array).levels, levels)
    other = replace(made, array=1.0 - made.array)
    np.testing.assert_array_equal(other.levels, 255 - levels)
