"""Replaced files: whole or untouched, whoever interrupts."""

import os
import stat

import pytest

from distal.file_writer import SaveError, replacement


def write(path, data=b"new"):
    with replacement(path) as file:
        file.write(data)


def test_file_is_replaced_and_nothing_else_is_left(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(b"old")
    write(path)
    assert path.read_bytes() == b"new"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("interruption", [KeyboardInterrupt, ValueError, SystemExit])
def test_interrupted_writer_leaves_the_old_file_alone(tmp_path, interruption):
    path = tmp_path / "a"
    path.write_bytes(b"old")
    with pytest.raises(interruption), replacement(path) as file:
        file.write(b"half")
        raise interruption
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_full_disk_is_one_clear_line(tmp_path):
    full = r"cannot write .*a: No space left on device"
    with pytest.raises(SaveError, match=full), replacement(tmp_path / "a"):
        raise OSError(28, "No space left on device")
    assert list(tmp_path.iterdir()) == []


def test_umask_decides_who_may_read(tmp_path):
    before = os.umask(0o027)
    try:
        write(tmp_path / "a")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "a").stat().st_mode) == 0o640


def test_link_keeps_pointing_where_it_did(tmp_path):
    (tmp_path / "target").write_bytes(b"old")
    (tmp_path / "link").symlink_to("target")
    write(tmp_path / "link")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "target").read_bytes() == b"new"


def test_longest_name_is_possible(tmp_path):
    write(tmp_path / ("a" * 255))
    assert len(list(tmp_path.iterdir())) == 1


def test_what_is_no_file_is_not_destroyed(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "folder").mkdir()
    with pytest.raises(SaveError, match="no ordinary file"):
        write(tmp_path / "pipe")
    with pytest.raises(SaveError, match="it is a folder"):
        write(tmp_path / "folder")
    assert stat.S_ISFIFO((tmp_path / "pipe").stat().st_mode)


def test_missing_folder_is_named(tmp_path):
    with pytest.raises(SaveError, match="there is no folder"):
        write(tmp_path / "nowhere" / "a")
    with pytest.raises(SaveError, match="cannot write"):
        write(tmp_path / ("a" * 300))


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="root may write anywhere")
def test_unwritable_folder_is_named(tmp_path):
    tmp_path.chmod(0o555)
    with pytest.raises(SaveError, match="is not writable"):
        write(tmp_path / "a")
