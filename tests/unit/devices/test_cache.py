"""The kernel cache: whole or nothing, ours or not at all."""

from __future__ import annotations

import fcntl
import os
import resource
import stat
import subprocess
import sys
import threading
import time
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


def test_swapped_files_are_nothing(folder: Path) -> None:
    cache = Cache(folder)
    cache.store("a", b"code of a")
    cache.store("b", b"code of b")
    first, second = folder / "a.kernel", folder / "b.kernel"
    held = first.read_bytes()
    first.write_bytes(second.read_bytes())
    second.write_bytes(held)
    assert cache.load("a") is None
    assert cache.load("b") is None
    cache.store("a", b"code of a")
    assert cache.load("a") == b"code of a"


def test_the_key_and_the_content_do_not_run_into_each_other(folder: Path) -> None:
    cache = Cache(folder)
    cache.store("ab", b"c")
    (folder / "ab.kernel").rename(folder / "a.kernel")
    data = (folder / "a.kernel").read_bytes()
    (folder / "a.kernel").write_bytes(data[:-1] + b"bc")
    assert cache.load("a") is None


def test_every_flipped_bit_and_every_cut_is_found(folder: Path) -> None:
    cache = Cache(folder)
    cache.store("a", b"code of a kernel")
    file = folder / "a.kernel"
    data = file.read_bytes()
    for place in range(len(data)):
        changed = bytearray(data)
        changed[place] ^= 1 << (place % 8)
        file.write_bytes(changed)
        assert cache.load("a") is None, place
        file.write_bytes(data[:place])
        assert cache.load("a") is None, place
    file.write_bytes(data + b"x")
    assert cache.load("a") is None
    file.write_bytes(data)
    assert cache.load("a") == b"code of a kernel"


@pytest.mark.parametrize("sort", ["folder", "pipe", "socket"])
def test_what_is_no_file_is_nothing_and_is_replaced(folder: Path, sort: str) -> None:
    cache = Cache(folder)
    cache.store("a", b"code")
    place = folder / "a.kernel"
    place.unlink()
    if sort == "folder":
        place.mkdir()
    elif sort == "pipe":
        os.mkfifo(place)
    else:
        os.mknod(place, stat.S_IFSOCK | 0o600)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert cache.load("a") is None
    assert cache.store("a", b"new")
    assert cache.load("a") == b"new"


def test_a_file_larger_than_the_limit_is_not_read_and_not_written(folder: Path) -> None:
    cache = Cache(folder, limit=1000)
    assert not cache.store("a", bytes(1000))
    Cache(folder).store("a", bytes(1000))
    assert cache.load("a") is None
    assert Cache(folder).load("a") == bytes(1000)


def test_a_full_disk_leaves_what_was_there(folder: Path) -> None:
    cache = Cache(folder)
    cache.store("a", b"code")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))  # as EFBIG, in mid file
    try:
        stored = cache.store("a", bytes(100_000))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert not stored
    assert cache.load("a") == b"code"
    assert [file.name for file in folder.iterdir()] == ["a.kernel"]


def test_leftovers_of_killed_writers_go_and_those_of_living_ones_stay(folder: Path) -> None:
    cache = Cache(folder)
    cache.store("a", b"code")
    old = time.time() - module.LEFTOVER_AGE_S - 60.0
    names = {
        ".new-0123456789abcdef": old,
        ".new-x1_y2z3a": old,  # as earlier versions called them
        ".new-fedcba9876543210": old,  # a stopped writer holds it
        ".new-1111111111111111": time.time(),
        ".new-2222222222222222": time.time() + 10 * module.LEFTOVER_AGE_S,  # a clock put back
        ".new-notes of the user.txt": old,
        "notes": old,
    }
    for name, when in names.items():
        (folder / name).write_bytes(b"half")
        os.utime(folder / name, (when, when))
    (folder / ".new-aaaaaaaaaaaaaaaa").symlink_to(folder / "notes")
    module._stored_since_scan.clear()  # as in another process
    with (folder / ".new-fedcba9876543210").open() as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        cache.store("b", b"code")
    left = {file.name for file in folder.iterdir()} - {"a.kernel", "b.kernel"}
    assert left == {*list(names)[2:], ".new-aaaaaaaaaaaaaaaa"}


def test_a_link_of_another_user_to_a_folder_of_ours_is_not_followed(
    folder: Path, tmp_path: Path
) -> None:
    Cache(folder).store("a", b"code")
    link = tmp_path / "link"
    link.symlink_to(folder)
    assert Cache(link).load("a") == b"code"
    if os.geteuid() != 0:
        pytest.skip("only root can give a link to another user")
    os.chown(link, 12345, 12345, follow_symlinks=False)
    module._warned.clear()
    with pytest.warns(RuntimeWarning, match="others"):
        assert Cache(link).load("a") is None
    assert not Cache(link).store("b", b"code")


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


def test_a_process_reads_all_sizes_at_its_first_store_and_each_sixteenth_of_the_limit(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scans: list[int] = []
    shrink = Cache._shrink
    monkeypatch.setattr(Cache, "_shrink", lambda self, at: (scans.append(i), shrink(self, at)))
    cache = Cache(folder, limit=160_000)
    for i in range(100):
        cache.store(f"k{i:02d}", bytes(3000))
    # Each file has 48 bytes more; the fourth since the last scan passes 10,000 bytes.
    assert scans == [0, *range(4, 100, 4)]
    assert cache.size()[1] <= 160_000 * 17 // 16
    assert cache.load("k99") is not None


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
        "cache.os.replace = lambda *_, **__: os._exit(9)\n"
        f"cache.Cache(Path({str(folder)!r})).store('b', b'half')\n"
    )
    result = subprocess.run([sys.executable, "-c", text], check=False, timeout=60)
    assert result.returncode == 9
    assert Cache(folder).load("a") == b"code"
    assert Cache(folder).load("b") is None
    (left,) = (file for file in folder.iterdir() if file.name.startswith(".new-"))
    old = time.time() - module.LEFTOVER_AGE_S - 1.0
    os.utime(left, (old, old))
    module._stored_since_scan.clear()  # as in another process
    Cache(folder).store("c", b"code")
    assert not left.exists()


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
