"""What is kept beside an output: for the same video only, by one process at a time."""

import os
import stat
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

import pytest

from distal.file_writer import SaveError
from distal.video.store import Store

MANIFEST = {"program": "a", "size": [640, 480], "quality": 80.0, "parameters": {}}


def opened(output, manifest=MANIFEST, fresh=False):
    told = []
    store = Store(output)
    store.open(manifest, fresh, told.append)
    return store, told


def test_a_folder_beside_the_output_that_goes_when_it_is_empty(tmp_path):
    store, told = opened(tmp_path / "out.mp4")
    assert store.folder == tmp_path / ".out.mp4.distal"
    assert store.folder.is_dir()
    store.close()
    assert list(tmp_path.iterdir()) == []
    assert told == []


def test_pieces_stay_for_the_same_video_and_half_ones_go(tmp_path):
    store, _ = opened(tmp_path / "out.mp4")
    store.path("000000-000119.mp4").write_bytes(b"whole")
    store.path("000120-000239.partial.mp4").write_bytes(b"half")
    store.close()
    store, told = opened(tmp_path / "out.mp4")
    assert [path.name for path in store.items()] == ["000000-000119.mp4"]
    assert told == []


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"size": [64, 48]}, "starts again: size was [640, 480], is [64, 48]"),
        ({"program": "b"}, "starts again: the scene has changed"),
        (
            {"parameters": {"glow": 1.0}, "quality": 60.0},
            "starts again: quality was 80.0, is 60.0; parameters have changed",
        ),
    ],
)
def test_another_video_begins_anew_and_says_why(tmp_path, change, words):
    store, _ = opened(tmp_path / "out.mp4")
    store.path("000000-000119.mp4").write_bytes(b"whole")
    store.close()
    store, told = opened(tmp_path / "out.mp4", {**MANIFEST, **change})
    assert store.items() == []
    assert told == [words]


def test_fresh_begins_anew(tmp_path):
    store, _ = opened(tmp_path / "out.mp4")
    store.path("000000-000119.mp4").write_bytes(b"whole")
    store.close()
    store, told = opened(tmp_path / "out.mp4", fresh=True)
    assert store.items() == []
    assert told == []


def test_a_broken_manifest_is_another_video(tmp_path):
    store, _ = opened(tmp_path / "out.mp4")
    store.path("000000-000119.mp4").write_bytes(b"whole")
    store.path("manifest.json").write_bytes(b"{")
    store.close()
    store, _ = opened(tmp_path / "out.mp4")
    assert store.items() == []


def test_two_processes_do_not_write_one_output(tmp_path):
    pytest.importorskip("fcntl")
    code = (
        "import sys; from pathlib import Path; from distal.video.store import Store\n"
        f"store = Store(Path({str(tmp_path / 'out.mp4')!r})); store.open({{}}, False, print)\n"
        "store.path('piece.mp4').write_bytes(b'x'); print('holds', flush=True); sys.stdin.read()"
    )
    other = subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    try:
        assert other.stdout.readline() == "holds\n"
        with pytest.raises(SaveError) as caught:
            opened(tmp_path / "out.mp4")
        assert str(caught.value) == f"another process is writing {tmp_path / 'out.mp4'}"
        assert (tmp_path / ".out.mp4.distal" / "piece.mp4").exists()
    finally:
        other.communicate("")
    opened(tmp_path / "out.mp4", {})[0].close()  # the lock went with the process


def test_a_lock_that_a_forked_process_holds_until_it_begins_is_waited_for(tmp_path):
    store = opened(tmp_path / "out.mp4", {})[0]
    store.path("piece.mp4").write_bytes(b"x")
    held = os.dup(store._lock.fileno())
    store.close()
    timer = threading.Timer(0.1, os.close, (held,))
    timer.start()
    opened(tmp_path / "out.mp4", {})[0].close()
    timer.join()


def test_a_folder_that_cannot_be_made(tmp_path):
    (tmp_path / ".out.mp4.distal").write_bytes(b"a file")
    with pytest.raises(SaveError, match=r"cannot write .*: File exists"):
        opened(tmp_path / "out.mp4")


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="needs two users")
@pytest.mark.parametrize("mode", [0o1777, 0o777])
def test_a_folder_of_another_user_is_not_used(mode):
    """FFmpeg would write through links that the other user puts there."""
    with tempfile.TemporaryDirectory() as folder:
        os.chmod(folder, mode)
        store = Store(Path(folder) / "out.mp4")
        store.folder.mkdir()
        os.mkfifo(store.folder / "lock")  # opening it would wait for ever
        os.chown(store.folder, 65534, 65534)
        with pytest.raises(SaveError, match="it belongs to another user, in a folder that is sha"):
            store.open({}, False, print)
        assert os.listdir(store.folder) == ["lock"]


def test_nobody_else_enters_the_folder(tmp_path):
    old = os.umask(0)
    try:
        store, _ = opened(tmp_path / "out.mp4")
        assert stat.S_IMODE(store.folder.stat().st_mode) == 0o700
        store.close()
    finally:
        os.umask(old)
