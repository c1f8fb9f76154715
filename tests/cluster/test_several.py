"""Several clients at one scheduler; workers of other versions and of other processors."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading

import pytest
from distributed import Client

import distal
from distal import Box, Scene, Sphere
from distal.cluster import WorkerPool
from distal.devices.base import Cancelled
from distal.devices.features import chosen_level
from distal.lang import Frame, image, sin, vec3
from distal.video import video
from tests.cluster.conftest import local_cluster
from tests.cluster.schedulers import end, scheduler, wait, worker

FILM = {"duration": 1.5, "fps": 12, "size": (64, 48), "quality": "lossless"}
SCENES = {"box": Scene(Box(0.7)), "sphere": Scene(Sphere(0.6))}


def together(*work):
    """Do several things at the same time, each on a thread; return their results or errors."""
    found = [None] * len(work)

    def run(number):
        try:
            found[number] = work[number]()
        except BaseException as error:
            found[number] = error

    threads = [threading.Thread(target=run, args=(i,)) for i in range(len(work))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return found


@pytest.mark.parametrize("names", [("box", "box"), ("box", "sphere")])
def test_two_clients_at_once(client, tmp_path, names):
    """The same scene, whose program they share, and two scenes."""
    for name in set(names):
        video(SCENES[name], tmp_path / f"{name}.mp4", **FILM)
    with Client(client.scheduler.address, set_as_default=False) as other:
        results = together(
            *(
                lambda n=n, name=name, by=by: video(
                    SCENES[name], tmp_path / f"{n}.mp4", cluster=by, **FILM
                )
                for n, (name, by) in enumerate(zip(names, (client, other), strict=True))
            )
        )
    assert [made.rendered for made in results] == [18, 18]
    for number, name in enumerate(names):
        film = (tmp_path / f"{number}.mp4").read_bytes()
        assert film == (tmp_path / f"{name}.mp4").read_bytes()


def test_one_client_is_cancelled_and_the_other_goes_on(client, tmp_path):
    """They have the same scene: what the cancelled one has sent, the other one needs."""
    scene, seen = SCENES["box"], []
    video(scene, tmp_path / "alone.mp4", **FILM)
    with Client(client.scheduler.address, set_as_default=False) as other:
        cancelled, made = together(
            lambda: video(
                scene,
                tmp_path / "cancelled.mp4",
                cluster=other,
                progress=lambda done, *_: seen.append(done),
                cancel=lambda: len(seen) >= 3,
                **{**FILM, "duration": 30},
            ),
            lambda: video(scene, tmp_path / "film.mp4", cluster=client, **FILM),
        )
    assert isinstance(cancelled, Cancelled) and made.rendered == 18
    assert (tmp_path / "film.mp4").read_bytes() == (tmp_path / "alone.mp4").read_bytes()


@image
def endless(frame: Frame) -> vec3:
    """Never ends after the first second, unless it is stopped."""
    total, i = 0.0, 0
    while i < 10 or frame.time > 1.0:
        total += sin(float(i))
        i = (i + 1) % 1000000
    return vec3(total)


def running(dask_worker):
    """The number of tasks that the threads of a worker do, also of those that nobody wants."""
    return dask_worker.state.executing_count


def test_a_running_task_stops_when_it_is_cancelled(client):
    """Not only those that have not begun: the worker is free for others at once."""
    seen, pool = [], WorkerPool(client, timeout=250.0)
    endless.render((256, 192), cluster=pool)  # so that the workers have compiled it

    def cancel():
        seen.append(sum(client.run(running).values()) > 0)
        return sum(seen) > 10

    with pytest.raises(Cancelled):
        endless.render((256, 192), time=2.0, cluster=pool, cancel=cancel)
    # If they did not stop, the limit of time would stop them long after this.
    wait(lambda: not any(client.run(running).values()), 100.0)
    tinted = Scene(Box(0.5))
    assert (tinted.render((32, 24), cluster=client).array == tinted.render((32, 24)).array).all()


COMMAND = """
import sys
from distal.cli import main
sys.argv = ["distal", *{arguments!r}]
main()
"""


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT])
def test_a_command_that_is_killed_is_continued(tmp_path, number):
    """Its tasks end with it, and the next command does only what is missing."""
    file, film = tmp_path / "scheduler.json", tmp_path / "film.mp4"
    arguments = [
        *("video", "example:raymarcher", "--duration", "60", "--fps", "5", "--size", "160x120"),
        *("-o", str(film), "--cluster", str(file), "--progress", "json"),
    ]
    code = COMMAND.format(arguments=arguments)
    with scheduler(file):
        started = worker(file)
        try:
            command, pipe = [sys.executable, "-c", code], subprocess.PIPE
            with subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True) as first:
                for line in first.stdout:
                    if json.loads(line)["done"] > 0.3:
                        break
                os.kill(first.pid, number)
                rest = first.stderr.read()
            assert "Traceback" not in rest
            assert first.returncode == (-signal.SIGKILL if number == signal.SIGKILL else 130)
            assert list((tmp_path / ".film.mp4.distal").glob("*-*.mp4"))
            second = subprocess.run(command, capture_output=True, text=True, timeout=300)
        finally:
            end(started)
    assert second.returncode == 0, second.stderr
    assert "continues: " in second.stdout + second.stderr and film.exists()


OTHER_VERSION = "import distal.version\ndistal.version.__version__ = '0.0.9'\n"


def test_a_late_worker_of_another_version_is_dropped(tmp_path):
    """At the beginning such a worker is refused; one that joins later is dropped."""
    told, scene = [], SCENES["sphere"]
    file = tmp_path / "scheduler.json"
    with scheduler(file):
        first = worker(file)
        late = None
        with Client(scheduler_file=str(file), set_as_default=False) as client:
            try:
                wait(client.nthreads)
                pool = WorkerPool(client, tell=told.append)
                pool.check()
                late = worker(file, "--preload", OTHER_VERSION)
                wait(lambda: len(client.nthreads()) == 2)
                (other,) = set(client.nthreads()) - {
                    worker for worker, level in client.run(version).items() if level != "0.0.9"
                }
                made = scene.render((200, 400), cluster=pool)
                wait(lambda: len(client.nthreads()) == 1)
            finally:
                end(*filter(None, (first, late)))
    assert told == [
        f"the worker {other} has distal 0.0.9, this process {distal.__version__}: it is dropped, "
        "others go on"
    ]
    assert (made.array == scene.render((200, 400)).array).all()


def version():
    import distal.version  # noqa: PLC0415 (on a worker)

    return distal.version.__version__


def test_workers_of_another_level_compile_their_own():
    """They render with what their processors have, and a line says so."""
    own, other = chosen_level().name, "sse4.2"
    if own == other:
        pytest.skip("this processor has the lower level")
    told = []
    with local_cluster(1, env={"DISTAL_CPU": other}) as client:
        made = SCENES["box"].render((48, 32), cluster=WorkerPool(client, tell=told.append))
    assert told == [
        f"a worker computes with {other}, this machine with {own}: the last bits of pixels may "
        "differ"
    ]
    alone = SCENES["box"].render((48, 32)).array
    assert abs(made.array - alone).max() < 2.0 / 255.0
