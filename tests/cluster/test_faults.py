"""Workers that end, hang, or come late; a scheduler that ends; errors of tasks."""

from __future__ import annotations

import os
import random
import signal
import socket
import threading
import time
from contextlib import suppress

import psutil
import pytest
from distributed import LocalCluster
from distributed.client import ClosedClientError

import distal
from distal.cluster import ClusterError, WorkerPool, connected, connecting, watch
from distal.cluster import pool as pools
from distal.cluster.errors import TaskError
from distal.lang import Frame, fract, image, sin, vec3
from distal.video import video
from tests.cluster.conftest import local_cluster
from tests.cluster.schedulers import end, scheduler, wait, worker

SIZE = (96, 64)
FRAMES = 40


@image
def moving(frame: Frame) -> vec3:
    """Some work for each pixel."""
    at = frame.coord / frame.resolution
    total = 0.0
    for i in range(400):
        total += sin(at.x * float(i) + frame.time) * sin(at.y * 3.0 + float(i))
    return fract(vec3(total, at.x + frame.time, at.y))


def film(path, **options):
    """A film whose segments and file are compared byte by byte."""
    return video(
        moving, path, duration=FRAMES / 20, fps=20, size=SIZE, quality="lossless", **options
    )


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    path = tmp_path_factory.mktemp("alone") / "film.mp4"
    film(path)
    return path.read_bytes()


def processes(client):
    """The process of each worker."""
    return {w: int(p) for w, p in client.run(os.getpid).items()}


def test_films_are_equal(client, tmp_path, alone):
    film(tmp_path / "film.mp4", cluster=client)
    assert (tmp_path / "film.mp4").read_bytes() == alone


def test_numbered_frames_are_equal(client, tmp_path):
    for name, cluster in (("alone", None), ("together", client)):
        path = tmp_path / name / "%03d.png"
        video(moving, path, duration=0.5, fps=12, size=SIZE, cluster=cluster)
    for file in sorted((tmp_path / "alone").iterdir()):
        assert (tmp_path / "together" / file.name).read_bytes() == file.read_bytes()


@pytest.mark.sample(7)
@pytest.mark.parametrize("seed", range(20))
def test_killed_workers_lose_nothing(tmp_path, alone, seed):
    rng = random.Random(seed)
    with local_cluster(2) as client:
        running = True

        def kill():
            while running:
                time.sleep(rng.uniform(0.05, 0.4))
                if not running:
                    return
                try:
                    os.kill(rng.choice(list(processes(client).values())), signal.SIGKILL)
                except (ProcessLookupError, IndexError, OSError):
                    continue
                time.sleep(3.0)  # more deaths of one task than Dask allows are an error

        killer = threading.Thread(target=kill)
        killer.start()
        try:
            made = film(tmp_path / "film.mp4", cluster=client)
        finally:
            running = False
            killer.join()
    assert made.rendered == FRAMES
    assert (tmp_path / "film.mp4").read_bytes() == alone


def test_a_worker_that_hangs_is_passed_over(tmp_path, alone, monkeypatch):
    monkeypatch.setattr(watch, "GRACE_S", 10.0)  # also for the import of the other worker
    told = []
    with local_cluster(2) as client:
        pool = WorkerPool(client, timeout=5.0, tell=told.append)
        pool.check()
        hung = processes(client)
        worker, process = sorted(hung.items())[0]
        os.kill(process, signal.SIGSTOP)
        try:
            film(tmp_path / "film.mp4", cluster=pool)
        finally:
            os.kill(process, signal.SIGCONT)
    assert (tmp_path / "film.mp4").read_bytes() == alone
    assert told == [
        f"the worker {worker} has finished nothing for more than 15 s: it is dropped, others go on"
    ]


def test_a_worker_that_comes_late_helps(tmp_path, alone):
    with local_cluster(1) as client:
        client.cluster.scale(2)
        film(tmp_path / "film.mp4", cluster=client)
    assert (tmp_path / "film.mp4").read_bytes() == alone


def test_a_lost_scheduler_keeps_what_is_finished(tmp_path, monkeypatch):
    long = {"duration": 6, "fps": 20, "size": SIZE, "quality": "lossless"}
    file = tmp_path / "scheduler.json"
    with scheduler(file) as process:
        started = worker(file)

        def progress(done, total, what):
            if done == 60:
                end(process)

        def closed(*given, **more):
            raise ClosedClientError  # as a client does that has already noticed it

        try:
            with connected(str(file)) as pool:
                wait(pool.client.nthreads)
                monkeypatch.setattr(pool.client, "cancel", closed)
                with pytest.raises(ClusterError, match=r"is lost; what is finished is kept"):
                    video(moving, tmp_path / "film.mp4", cluster=pool, progress=progress, **long)
        finally:
            end(started)
    # The same command goes on, here or on another cluster.
    made = video(moving, tmp_path / "film.mp4", **long)
    assert made.frames == 120 and made.rendered == 80
    video(moving, tmp_path / "whole.mp4", **long)
    assert (tmp_path / "film.mp4").read_bytes() == (tmp_path / "whole.mp4").read_bytes()


def test_a_scheduler_without_workers(tmp_path, monkeypatch):
    monkeypatch.setattr(pools, "_JOIN_S", 0.5)
    file = tmp_path / "scheduler.json"
    with (
        scheduler(file),
        connected(str(file)) as pool,
        pytest.raises(ClusterError, match=r"has no workers: start some with 'dask worker"),
    ):
        pool.check()


def test_when_no_workers_are_left(tmp_path, monkeypatch):
    """A line says that it waits for some; without them it ends."""
    monkeypatch.setattr(watch, "GRACE_S", 2.0)
    told = []
    file = tmp_path / "scheduler.json"
    with scheduler(file):
        started = worker(file)
        with connected(str(file), timeout=1.0, tell=told.append) as pool:
            wait(pool.client.nthreads)
            pool.check()
            end(started)
            wait(lambda: not pool.client.nthreads())
            with pytest.raises(ClusterError) as caught:
                film(tmp_path / "film.mp4", cluster=pool)
    address = str(caught.value).split()[2]
    assert str(caught.value) == (
        f"the scheduler {address} has had no workers for 3 s; what is finished is kept"
    )
    assert told == [f"the scheduler {address} has no workers left: waiting"]


def test_the_watch_asks_the_scheduler(client, monkeypatch):
    """What the client has noted may be what its timer asked for: no workers."""
    told = []
    pool = WorkerPool(client, tell=told.append)
    monkeypatch.setattr(client, "scheduler_info", lambda n_workers=0: {"workers": {}})
    pool.watch._next = 0.0
    pool.watch.look()
    assert told == []


def test_local_processes_that_end_late(monkeypatch):
    """What is finished then is finished: no error."""
    close = LocalCluster.close

    def late(cluster):
        close(cluster)
        raise TimeoutError

    monkeypatch.setattr(LocalCluster, "close", late)
    with connected("local:1") as pool:
        pool.check()


def test_a_worker_that_each_picture_kills(client, tmp_path, monkeypatch):
    with local_cluster(2) as own:
        pool = WorkerPool(own)
        pool.check()
        with pytest.raises(TaskError, match=r"^the picture at 1 s ended each of the 4 workers"):
            pool.result(lambda: own.submit(os._exit, 1), None, "the picture at 1 s")
        with pytest.raises(TaskError, match=r"^it failed on a worker: invalid literal"):
            pool.result(lambda: own.submit(int, "x"), None, "it")


@pytest.mark.parametrize(
    ("where", "words"),
    [
        ("nowhere", "'nowhere' is no cluster; --cluster takes local, local:4, tcp://host:8786"),
        ("missing.json", "there is no file missing.json; --cluster takes local"),
        ("broken.json", "broken.json is no file of a scheduler"),
        ("tcp://127.0.0.1:1", "no scheduler answers at tcp://127.0.0.1:1: "),
        ("tcp://127.0.0.1", "'tcp://127.0.0.1' has no port: tcp://host:8786"),
        ("http://127.0.0.1:80", "'http://127.0.0.1:80' is no cluster; --cluster takes local"),
        ("local:0", "'local:0': local:N has 1 to 1024 processes"),
        ("local:many", "'local:many': local:N has 1 to 1024 processes"),
    ],
)
def test_addresses(where, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(connecting, "_CONNECT_S", 2.0)
    (tmp_path / "broken.json").write_text('{"address": 5')
    with pytest.raises(ClusterError) as caught, connected(where):
        pass
    assert str(caught.value).startswith(words)
    assert distal.__version__


@pytest.mark.parametrize("given", [b"", b"HTTP/1.0 400 Bad request syntax\r\n\r\n"])
def test_a_server_that_is_no_scheduler(given, monkeypatch):
    """Dask waits for an answer without end, or takes it for the length of a message."""
    monkeypatch.setattr(connecting, "_CONNECT_S", 2.0)
    accepted = []  # else they would be closed
    with socket.create_server(("127.0.0.1", 0)) as server:

        def answer():
            with suppress(OSError):
                while True:
                    accepted.append(server.accept()[0])
                    accepted[-1].sendall(given)

        threading.Thread(target=answer, daemon=True).start()
        where = f"tcp://127.0.0.1:{server.getsockname()[1]}"
        with pytest.raises(ClusterError) as caught, connected(where):
            pass
    assert str(caught.value).startswith(f"no scheduler answers at {where}: ")


def test_local_processes_listen_on_this_machine_alone():
    with connected("local:1") as pool:
        wait(pool.client.nthreads)
        own = psutil.Process()
        places = [
            each.laddr.ip
            for process in (own, *own.children(recursive=True))
            for each in process.net_connections("inet")
            if each.status == psutil.CONN_LISTEN
        ]
    assert len(places) >= 3 and set(places) == {"127.0.0.1"}
