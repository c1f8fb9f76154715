"""The kernel cache: whole or nothing, ours or not at all."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import warnings
from pathlib import Path

import pytest

from distal.devices import cache as module
from distal.devices.cache import Cache, default_folder


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "kernels"


def test_what_is_stored_is_loaded(folder: Path) -> None:
    assert Cache(folder).load("a") is None
    assert Cache(folder).store("a", b"code")
    assert Cache(folder).load("a") == b"code"
    assert folder.stat().st_mode & 0o077 == 0


@pytest.mark.parametrize("damage", ["cut", "changed", "empty", "foreign"])
def test_a_broken_file_is_nothing_and_is_replaced(folder: Path, damage: str) -> None:
    cache = Cache(folder)
    cache.store("a", b"code" * 100)
    (file,) = folder.iterdir()
    data = file.read_bytes()
    broken = {
        "cut": data[:-7],
        "changed": data[:-1] + b"?",
        "empty": b"",
        "foreign": b"something else altogether, and longer than a header is",
    }[damage]
    file.write_bytes(broken)
    assert cache.load("a") is None
    cache.store("a", b"new")
    assert cache.load("a") == b"new"


def test_a_file_that_others_can_write_is_not_used(folder: Path) -> None:
    cache = Cache(folder)
    cache.store("a", b"code")
    (file,) = folder.iterdir()
    file.chmod(0o666)
    module._warned.clear()
    with pytest.warns(RuntimeWarning, match="others can write"):
        assert cache.load("a") is None


def test_a_folder_that_others_can_write_is_not_used_and_said_once(folder: Path) -> None:
    cache = Cache(folder)
    cache.store("a", b"code")
    folder.chmod(0o777)
    module._warned.clear()
    with pytest.warns(RuntimeWarning, match="written by others"):
        assert cache.load("a") is None
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert cache.load("a") is None
        assert not cache.store("b", b"code")


def test_a_link_is_not_followed(folder: Path, tmp_path: Path) -> None:
    cache = Cache(folder)
    cache.store("a", b"code")
    (file,) = folder.iterdir()
    target = tmp_path / "elsewhere"
    file.rename(target)
    file.symlink_to(target)
    assert cache.load("a") is None


def test_another_users_file_is_not_used(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cache = Cache(folder)
    cache.store("a", b"code")
    other = os.geteuid() + 1
    monkeypatch.setattr(os, "geteuid", lambda: other)
    module._warned.clear()
    with pytest.warns(RuntimeWarning):
        assert cache.load("a") is None


def test_a_place_that_cannot_be_written_is_no_error(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("in the way")
    cache = Cache(blocked / "kernels")
    assert not cache.store("a", b"code")
    assert cache.load("a") is None
    assert not Cache(None).store("a", b"code")


def test_the_longest_unused_go_first(folder: Path) -> None:
    cache = Cache(folder, limit=5000)
    for i in range(4):
        cache.store(f"k{i}", bytes(1000))
        os.utime(folder / f"k{i}.kernel", (i + 1, i + 1))
    cache.load("k0")  # used just now
    cache.store("k4", bytes(1000))
    assert cache.load("k0") is not None
    assert cache.load("k1") is None
    assert cache.load("k4") is not None
    assert cache.size()[1] <= 5000


def test_writers_side_by_side_leave_whole_files(folder: Path) -> None:
    payloads = [bytes([i]) * 200_000 for i in range(8)]
    seen: list[bytes | None] = []

    def write(payload: bytes) -> None:
        cache = Cache(folder)
        for _ in range(10):
            cache.store("same", payload)
            seen.append(cache.load("same"))

    threads = [threading.Thread(target=write, args=(p,)) for p in payloads]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(found in payloads for found in seen)
    assert [f.name for f in folder.iterdir()] == ["same.kernel"]


def test_a_writer_that_dies_leaves_nothing_that_counts(folder: Path) -> None:
    Cache(folder).store("a", b"code")
    text = (
        "import os, sys\n"
        "from pathlib import Path\n"
        "from distal.devices import cache\n"
        "cache.os.replace = lambda *_: os._exit(9)\n"
        f"cache.Cache(Path({str(folder)!r})).store('b', b'half')\n"
    )
    result = subprocess.run([sys.executable, "-c", text], check=False, timeout=60)
    assert result.returncode == 9
    assert Cache(folder).load("a") == b"code"
    assert Cache(folder).load("b") is None


def test_the_folder_follows_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("DISTAL_CACHE_DIR", "/some/where")
    assert default_folder() == Path("/some/where")
    monkeypatch.setenv("DISTAL_CACHE_DIR", "off")
    assert default_folder() is None
    monkeypatch.delenv("DISTAL_CACHE_DIR")
    if sys.platform.startswith("linux"):
        monkeypatch.setenv("XDG_CACHE_HOME", "/base")
        assert default_folder() == Path("/base/distal")
        monkeypatch.setenv("XDG_CACHE_HOME", "relative is ignored")
        monkeypatch.setenv("HOME", "/home/author")
        assert default_folder() == Path("/home/author/.cache/distal")
