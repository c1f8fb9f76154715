"""One way to write a file: whole or untouched, whoever interrupts, and nobody's text is lost."""

import errno
import fcntl
import os
import resource
import signal
import stat
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import contextmanager
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from distal import Sphere
from distal.file_writer import (
    ANY,
    ChangedError,
    LinkedError,
    SaveError,
    TakenError,
    check_destination,
    destinations,
    digest_of,
    locks,
    move_into_place,
    name_beside,
    replacement,
    save,
    state,
    temporary,
    writing,
)
from distal.images.picture import FORMATS

IS_ROOT = os.geteuid() == 0
needs_root = pytest.mark.skipif(not IS_ROOT, reason="needs a second user, so root")
NOBODY = 65534


def write(path, data=b"new"):
    with replacement(path) as file:
        file.write(data)


def moved(path, data):
    path.with_name("made").write_bytes(data)
    move_into_place(path.with_name("made"), path)


# Each way to write over a file.
WAYS = {
    "save": lambda path, data: save(path, data, expected=digest_of(path.read_bytes())),
    "in place": lambda path, data: save(path, data, in_place=True),
    "any": save,
    "replacement": write,
    "moved": moved,
}


@pytest.fixture(params=["exchange", "links", "neither"])
def system(request, monkeypatch):
    """What the system can do: exchange files, or give a file a second name, or neither."""

    def refused(*_):
        raise OSError(errno.EPERM, "Operation not permitted")

    if request.param != "exchange":
        monkeypatch.setattr(writing, "exchange", lambda *_: False)
    if request.param == "neither":
        monkeypatch.setattr(os, "link", refused)
    return request.param


@pytest.fixture
def shared():
    """A folder that all users share, like /tmp."""
    with tempfile.TemporaryDirectory() as folder:
        os.chmod(folder, 0o1777)
        yield Path(folder)


# Whole or untouched


@pytest.mark.parametrize("way", WAYS)
def test_file_is_replaced_and_nothing_else_is_left(tmp_path, way, system):
    path = tmp_path / "a"
    path.write_bytes(b"the old text")
    WAYS[way](path, b"new")
    assert path.read_bytes() == b"new"
    WAYS[way](path, b"longer than before")
    assert path.read_bytes() == b"longer than before"
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


@contextmanager
def longest_file(size):
    """Let writing fail past a size, as on a full disk."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, handler)


@pytest.mark.parametrize("way", sorted(WAYS.keys() - {"moved"}))
def test_failed_write_leaves_the_old_file_alone(tmp_path, way):
    path = tmp_path / "a"
    path.write_bytes(b"old" * 500)
    with longest_file(8192), pytest.raises(SaveError, match=r"^cannot write .*a: File too large$"):
        WAYS[way](path, b"new" * 10_000)
    assert path.read_bytes() == b"old" * 500
    assert list(tmp_path.iterdir()) == [path]
    path.unlink()
    with longest_file(8192), pytest.raises(SaveError, match="File too large"):
        save(path, b"new" * 10_000, expected=None)
    assert list(tmp_path.iterdir()) == []


@needs_root
def test_full_disk_leaves_nothing_behind(tmp_path):
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", tmp_path], capture_output=True
    )
    if mounted.returncode:
        pytest.skip("this container cannot mount")
    try:
        (tmp_path / "old").write_bytes(b"old" * 1000)
        for way in (WAYS["save"], WAYS["in place"], write):
            with pytest.raises(SaveError, match="No space left on device"):
                way(tmp_path / "old", bytes(100_000))
        with pytest.raises(SaveError, match="No space left on device"):
            save(tmp_path / "new", bytes(100_000), expected=None)
        assert (tmp_path / "old").read_bytes() == b"old" * 1000
        assert os.listdir(tmp_path) == ["old"]
        (tmp_path / "rest").write_bytes(bytes(60 * 1024))
        command = [sys.executable, "-m", "distal.cli", "new", str(tmp_path / "scene.py")]
        new = subprocess.run(command, capture_output=True, text=True)
        where = tmp_path / "scene.py"
        assert (new.returncode, new.stdout) == (1, "")
        assert new.stderr == f"error: cannot write {where}: No space left on device\n"
        assert sorted(os.listdir(tmp_path)) == ["old", "rest"]
    finally:
        subprocess.run(["umount", tmp_path], check=True)


@pytest.mark.parametrize("code", ["EINVAL", "ENOTSUP", "ENOSYS"])
def test_file_system_that_cannot_flush_is_written(tmp_path, monkeypatch, code):
    def refused(_):
        raise OSError(getattr(errno, code), "refused")

    monkeypatch.setattr(os, "fsync", refused)
    Sphere(1.0).render(size=(8, 6)).save(tmp_path / "a.png")
    save(tmp_path / "a.png", b"new", in_place=True)
    moved(tmp_path / "b", b"new")
    assert sorted(os.listdir(tmp_path)) == ["a.png", "b"]


def test_disk_that_fails_to_flush_is_an_error(tmp_path, monkeypatch):
    def refused(_):
        raise OSError(errno.EIO, "Input/output error")

    monkeypatch.setattr(os, "fsync", refused)
    with pytest.raises(SaveError, match="Input/output error"):
        write(tmp_path / "a")
    assert os.listdir(tmp_path) == []


KILLS = """
import os, signal, sys
from pathlib import Path
from distal.file_writer import digest_of, exchange, save, temporary, writing

folder, sort = Path(sys.argv[1]), sys.argv[2]
path, package = folder / "a", os.path.dirname(exchange.__file__)
exchange._function()
if sort == "links":
    writing.exchange = lambda *_: False

def in_child(work):
    child = os.fork()
    if child == 0:
        try:
            work()
        except BaseException as error:
            print(repr(error), flush=True)
            os._exit(1)
        os._exit(0)
    return os.waitpid(child, 0)[1]

def until(step):
    count = 0
    def traced(frame, event, _):
        nonlocal count
        file = frame.f_code.co_filename
        if not file.startswith(package) or file.endswith("destinations.py"):
            return None  # what changes nothing
        count += event == "line"
        if count == step:
            os.kill(os.getpid(), signal.SIGKILL)
        return traced
    sys.settrace(traced)

def first():
    until(step)
    save(path, b"new", expected=None if sort == "new" else digest_of(b"old"))

def second():
    temporary._searched.clear()
    expected = digest_of(path.read_bytes()) if path.exists() else None
    assert save(path, b"next", expected=expected).other is None

save(folder / "other", b"")  # this process has its file of locks
for step in range(1, 10_000):
    path.unlink(missing_ok=True)
    if sort != "new":
        path.write_bytes(b"old")
        path.chmod(0o640)
    status = in_child(first)
    text = path.read_bytes() if path.exists() else None
    assert text in (b"new", None if sort == "new" else b"old"), (step, text)
    assert sort == "new" or path.stat().st_mode & 0o777 == 0o640, step
    assert in_child(second) == 0, step
    assert sorted(os.listdir(folder)) == ["a", "other"], (step, os.listdir(folder))
    assert path.stat().st_nlink == 1
    if status == 0:
        break
    assert status == signal.SIGKILL, status
print(step)
"""


@pytest.mark.parametrize("sort", ["exchange", "links", "new"])
def test_process_killed_at_any_line_leaves_a_whole_file_and_the_next_cleans(tmp_path, sort):
    command = [sys.executable, "-c", KILLS, str(tmp_path), sort]
    result = subprocess.run(command, capture_output=True, text=True)
    assert result.returncode == 0, result.stdout + result.stderr
    assert int(result.stdout) > 80  # lines


# The mode and the owner


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("mode", [0o600, 0o640, 0o755, 0o666])
def test_mode_is_kept(tmp_path, way, mode):
    path = tmp_path / "a"
    path.write_bytes(b"old")
    path.chmod(mode)
    WAYS[way](path, b"new")
    assert stat.S_IMODE(path.stat().st_mode) == mode


def test_private_text_is_never_readable_by_others(tmp_path):
    (tmp_path / "a").touch(mode=0o600)
    with replacement(tmp_path / "a") as file:
        assert stat.S_IMODE(os.fstat(file.fileno()).st_mode) == 0o600


@pytest.mark.parametrize("mask", [0o027, 0o022, 0o077])
def test_umask_decides_who_may_read_a_new_file(tmp_path, mask):
    before = os.umask(mask)
    try:
        write(tmp_path / "a")
        save(tmp_path / "b", b"new", expected=None)
    finally:
        os.umask(before)
    for name in "ab":
        assert stat.S_IMODE((tmp_path / name).stat().st_mode) == 0o666 & ~mask


def test_attributes_are_kept(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(b"old")
    try:
        os.setxattr(path, "user.origin", b"here")
    except (AttributeError, OSError):
        pytest.skip("no extended attributes here")
    WAYS["save"](path, b"new")
    assert os.getxattr(path, "user.origin") == b"here"


@needs_root
@pytest.mark.parametrize("way", WAYS)
def test_root_keeps_the_owner(tmp_path, way):
    path = tmp_path / "a"
    path.write_bytes(b"old")
    os.chown(path, NOBODY, 12345)
    path.chmod(0o640)
    WAYS[way](path, b"new")
    info = path.stat()
    assert (info.st_uid, info.st_gid, info.st_mode & 0o777) == (NOBODY, 12345, 0o640)


def as_nobody(text, *words):
    """Run Python as another user; what is imported later may be in root's folders."""
    start = (
        "import os, sys, stat; from pathlib import Path; from distal.file_writer import *\n"
        "from distal.file_writer import exchange; exchange._function()\n"
        "sys.stdout.flush(); os.setgroups([12345]); os.setgid(65534); os.setuid(65534)\n"
    )
    environment = {**os.environ, "XDG_STATE_HOME": "", "HOME": "/nonexistent"}
    result = subprocess.run(
        [sys.executable, "-c", start + text, *map(str, words)],
        capture_output=True,
        text=True,
        env=environment,
    )
    assert result.returncode == 0, result.stderr
    return result.stdout


SAVE = """
try:
    save(Path(sys.argv[1]), b"new", expected=digest_of(Path(sys.argv[1]).read_bytes()))
except SaveError as error:
    print(error)
"""


@needs_root
@pytest.mark.parametrize(
    ("group", "mode", "kept_group", "kept_mode"),
    [(12345, 0o664, 12345, 0o664), (54321, 0o676, NOBODY, 0o666), (0, 0o642, NOBODY, 0o602)],
)
def test_group_is_kept_where_it_may_be(tmp_path, shared, group, mode, kept_group, kept_mode):
    shared.chmod(0o777)
    path = shared / "a"
    path.write_bytes(b"old")
    os.chown(path, 0, group)
    path.chmod(mode)
    text = SAVE if mode & 0o4 or group == 12345 else "save(Path(sys.argv[1]), b'new')"
    assert as_nobody(text, path) == ""
    info = path.stat()
    assert (info.st_uid, info.st_gid, info.st_mode & 0o777) == (NOBODY, kept_group, kept_mode)


@needs_root
def test_read_only_file_of_another_user_is_refused(shared):
    shared.chmod(0o777)
    (shared / "a").write_bytes(b"old")
    (shared / "a").chmod(0o644)
    assert as_nobody(SAVE, shared / "a") == f"cannot write {shared / 'a'}: it is read-only\n"


@pytest.mark.parametrize("way", WAYS)
def test_read_only_file_is_refused_before_anything_is_computed(tmp_path, way):
    path = tmp_path / "a"
    path.write_bytes(b"old")
    path.chmod(0o444)
    with pytest.raises(SaveError, match=r"^cannot write .*a: it is read-only$"):
        check_destination(path)
    with pytest.raises(SaveError, match="it is read-only"):
        WAYS[way](path, b"new")
    assert path.read_bytes() == b"old"


# Names: links, hard links, long ones


@pytest.mark.parametrize("way", WAYS)
def test_link_keeps_pointing_where_it_did(tmp_path, way):
    (tmp_path / "below").mkdir()
    (tmp_path / "below" / "target").write_bytes(b"old")
    (tmp_path / "through").symlink_to("below/../below")
    (tmp_path / "link").symlink_to("through/target")
    WAYS[way](tmp_path / "link", b"new")
    assert os.readlink(tmp_path / "link") == "through/target"
    assert (tmp_path / "below" / "target").read_bytes() == b"new"
    assert os.listdir(tmp_path / "below") == ["target"]


def test_link_to_nothing_is_followed(tmp_path):
    (tmp_path / "link").symlink_to(tmp_path / "target")
    save(tmp_path / "link", b"new", expected=None)
    assert (tmp_path / "target").read_bytes() == b"new"
    assert (tmp_path / "link").is_symlink()


def test_links_in_a_circle_are_one_line(tmp_path):
    (tmp_path / "a").symlink_to("b")
    (tmp_path / "b").symlink_to("a")
    with pytest.raises(SaveError, match=r"^cannot write .*a: its links lead in a circle$"):
        check_destination(tmp_path / "a")


@settings(suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(st.sampled_from(["a", "b", "up", "top", "away", "..", "."]), max_size=8))
def test_links_are_followed_as_the_system_does(parts):
    with tempfile.TemporaryDirectory() as folder:
        top = Path(os.path.realpath(folder))
        (top / "a" / "b").mkdir(parents=True)
        (top / "a" / "up").symlink_to("..")
        (top / "a" / "b" / "top").symlink_to(top)
        (top / "b").symlink_to("a/b")
        (top / "a" / "away").symlink_to(top / "b" / ".." / "nothing")
        path = top.joinpath(*parts)
        try:
            expected = os.path.realpath(path)
            os.lstat(os.path.dirname(expected))
        except OSError:
            return
        assert destinations._followed(path) == Path(expected)


LINK = "os.symlink(sys.argv[2], sys.argv[1])"


@needs_root
@pytest.mark.parametrize("mode", [0o1777, 0o777])
@pytest.mark.parametrize("way", sorted(WAYS.keys() - {"save"}))
def test_link_of_another_user_in_a_shared_folder_is_refused(tmp_path, shared, way, mode):
    shared.chmod(mode)
    for name, target, below in (("file", tmp_path / "a", ""), ("folder", tmp_path, "a")):
        (tmp_path / "a").write_bytes(b"old")
        as_nobody(LINK, shared / name, target)
        with pytest.raises(SaveError, match=f"{shared / name} is a link of another user, in a fo"):
            WAYS[way](shared / name / below, b"new")
        assert (tmp_path / "a").read_bytes() == b"old"


@needs_root
def test_link_of_another_user_elsewhere_is_followed(tmp_path, shared):
    shared.chmod(0o755)
    os.chown(shared, NOBODY, NOBODY)
    (tmp_path / "a").write_bytes(b"old")
    as_nobody(LINK, shared / "link", tmp_path / "a")
    write(shared / "link")
    assert (tmp_path / "a").read_bytes() == b"new"


@needs_root
def test_own_link_in_a_shared_folder_is_followed(tmp_path, shared):
    (shared / "link").symlink_to(tmp_path / "a")
    write(shared / "link")
    assert (tmp_path / "a").read_bytes() == b"new"


@needs_root
@pytest.mark.parametrize("way", WAYS)
def test_file_of_another_user_in_a_shared_folder_is_refused(shared, way):
    (shared / "a").write_bytes(b"old")
    (shared / "a").chmod(0o666)
    os.chown(shared / "a", NOBODY, NOBODY)
    with pytest.raises(SaveError, match="it belongs to another user, in a folder that is shared"):
        WAYS[way](shared / "a", b"new")


def test_other_names_of_a_file_are_not_left_behind_unsaid(tmp_path):
    path, other = tmp_path / "a", tmp_path / "b"
    path.write_bytes(b"old")
    other.hardlink_to(path)
    with pytest.raises(LinkedError, match=r"a: the file has 2 names \(hard links\)") as caught:
        save(path, b"new", expected=digest_of(b"old"))
    assert caught.value.names == 2
    assert path.read_bytes() == other.read_bytes() == b"old"
    save(path, b"new", expected=digest_of(b"old"), in_place=True)
    assert path.read_bytes() == other.read_bytes() == b"new"
    with replacement(path, in_place=True) as file:
        file.write(b"newer")
    assert path.read_bytes() == other.read_bytes() == b"newer"
    with pytest.warns(UserWarning, match=r"a had 2 names \(hard links\): the others keep the old"):
        write(path, b"picture")
    assert (path.read_bytes(), other.read_bytes()) == (b"picture", b"newer")


@pytest.mark.parametrize("suffix", FORMATS)
@pytest.mark.parametrize("length", [250, 254, 255])
def test_longest_name_is_possible(tmp_path, suffix, length):
    name = "x" * (length - len(suffix)) + suffix
    if suffix != ".exr":
        Sphere(1.0).render(size=(8, 6)).save(tmp_path / name)
    write(tmp_path / name)
    save(tmp_path / name, b"newer", expected=digest_of(b"new"))
    assert os.listdir(tmp_path) == [name]


def test_name_that_is_too_long_is_one_line(tmp_path):
    for action in (check_destination, write):
        with pytest.raises(SaveError, match=r"^cannot write .*xxx: File name too long$"):
            action(tmp_path / ("x" * 300))


@given(st.text(st.characters(exclude_characters="/\0", codec="utf-8"), min_size=1, max_size=300))
def test_companion_of_any_name_has_a_possible_name(name):
    if name in (".", ".."):
        return
    beside = name_beside(Path("folder") / name, ".distal", ".")
    assert len(os.fsencode(beside.name)) <= 255
    assert beside.parent == Path("folder") and beside.name.startswith(f".{name[:30]}")
    if len(os.fsencode(name)) <= 247:
        assert beside.name == f".{name}.distal"
    assert beside != name_beside(Path("folder") / (name + "x"), ".distal", ".")


def test_what_is_no_file_is_not_destroyed(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "folder").mkdir()
    with pytest.raises(SaveError, match="no ordinary file"):
        write(tmp_path / "pipe")
    with pytest.raises(SaveError, match="it is a folder"):
        write(tmp_path / "folder")
    assert stat.S_ISFIFO((tmp_path / "pipe").stat().st_mode)


def test_missing_folder_is_named(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(SaveError, match=r"there is no folder .*nowhere"):
        write(tmp_path / "nowhere" / "a")
    with pytest.raises(SaveError, match="/file is a file, no folder"):
        write(tmp_path / "file" / "a")
    with pytest.raises(SaveError, match="cannot write"):
        write(tmp_path / "a\0b")


def test_working_folder_that_is_gone_is_one_line(tmp_path, monkeypatch):
    (tmp_path / "gone").mkdir()
    monkeypatch.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    with pytest.raises(SaveError, match=r"^cannot write a: the working folder is gone$"):
        write(Path("a"))


@pytest.mark.skipif(IS_ROOT, reason="root may write anywhere")
def test_unwritable_folder_is_named(tmp_path):
    tmp_path.chmod(0o555)
    with pytest.raises(SaveError, match="is not writable"):
        write(tmp_path / "a")


def test_link_may_lead_to_another_file_system(tmp_path):
    elsewhere = Path("/dev/shm")
    if not elsewhere.is_dir() or elsewhere.stat().st_dev == tmp_path.stat().st_dev:
        pytest.skip("there is no second file system")
    with tempfile.TemporaryDirectory(dir=elsewhere) as folder:
        (tmp_path / "link").symlink_to(Path(folder) / "a")
        moved(tmp_path / "link", b"new")
        assert os.listdir(folder) == ["a"]
        assert os.listdir(tmp_path) == ["link"]


# What others save


def test_expectation_decides(tmp_path):
    path = tmp_path / "a"
    assert save(path, b"one", expected=None).digest == digest_of(b"one")
    with pytest.raises(ChangedError, match="it is there already") as caught:
        save(path, b"two", expected="")
    assert (caught.value.digest, caught.value.data) == (digest_of(b"one"), b"one")
    with pytest.raises(ChangedError, match="another program has changed it") as caught:
        save(path, b"two", expected=digest_of(b"zero"))
    assert (caught.value.digest, caught.value.data) == (digest_of(b"one"), b"one")
    assert save(path, b"two", expected=digest_of(b"one")).other is None
    assert save(path, b"three", expected=ANY).other is None
    path.unlink()
    with pytest.raises(ChangedError, match="it is gone") as caught:
        save(path, b"four", expected=digest_of(b"three"))
    assert (caught.value.digest, caught.value.data) == ("", None)
    assert list(tmp_path.iterdir()) == []


def renaming(path):
    path.with_name("theirs").write_bytes(b"theirs")
    os.rename(path.with_name("theirs"), path)


def writing_in_place(path):
    path.write_bytes(b"theirs")


def slowly(path):
    """Begin to write in place; go on later."""
    file = path.open("wb", buffering=0)

    def go_on():
        for part in (b"t", b"hei", b"rs"):
            time.sleep(0.1 if hasattr(fcntl, "F_SETLEASE") else 0.01)
            file.write(part)
        file.close()

    threading.Thread(target=go_on).start()


def later(path):
    """Open the file to change it, and go on later."""
    if not hasattr(fcntl, "F_SETLEASE"):
        pytest.skip("nothing tells that a file is open")
    file = path.open("r+b", buffering=0)

    def go_on():
        time.sleep(0.1)
        file.write(b"theirs")
        file.close()

    threading.Thread(target=go_on).start()


@pytest.mark.parametrize("how", [renaming, writing_in_place, slowly, later])
@pytest.mark.parametrize("moment", ["exchange", "link", "replace"])
def test_save_of_another_program_in_our_last_moment_is_returned(tmp_path, monkeypatch, how, moment):
    path = tmp_path / "a"
    path.write_bytes(b"old")
    if (how, moment) == (renaming, "replace"):
        return  # decision 95: lost where the system can exchange nothing
    calls = []

    def before(function):
        def called(*arguments):
            calls.append(moment)
            how(path)
            return function(*arguments)

        return called

    if moment == "exchange":
        monkeypatch.setattr(writing, "exchange", before(writing.exchange))
    else:
        monkeypatch.setattr(writing, "exchange", lambda *_: False)
        monkeypatch.setattr(os, moment, before(getattr(os, moment)))
    written = save(path, b"new", expected=digest_of(b"old"))
    assert calls == [moment]
    assert written.other == b"theirs"
    assert path.read_bytes() == b"new"
    assert list(tmp_path.iterdir()) == [path]


def test_file_that_appears_in_our_last_moment_stays(tmp_path, monkeypatch, system):
    path = tmp_path / "a"
    link, replace = os.link, os.replace
    if system == "neither":
        return  # decision 95: nothing but a look just before

    def linked(*arguments):
        path.write_bytes(b"theirs")
        return link(*arguments)

    monkeypatch.setattr(os, "link", linked)
    with pytest.raises(ChangedError) as caught:
        save(path, b"new", expected=None)
    assert caught.value.data == b"theirs"
    assert path.read_bytes() == b"theirs"
    assert replace is os.replace and list(tmp_path.iterdir()) == [path]


def test_equal_save_of_another_program_is_no_conflict(tmp_path, monkeypatch):
    path = tmp_path / "a"
    path.write_bytes(b"old")
    exchange = writing.exchange
    monkeypatch.setattr(
        writing, "exchange", lambda *paths: path.write_bytes(b"new") and exchange(*paths)
    )
    assert save(path, b"new", expected=digest_of(b"old")).other is None


@pytest.mark.parametrize("make", [os.mkfifo, os.mkdir, lambda path: os.symlink("b", path)])
def test_what_cannot_be_read_is_put_back(tmp_path, monkeypatch, make):
    path = tmp_path / "a"
    path.write_bytes(b"old")
    calls = []

    def exchanged(first, second):
        if not calls:
            path.unlink()
            make(path)
            calls.append(os.lstat(path).st_ino)
        return exchange(first, second)

    exchange = writing.exchange
    monkeypatch.setattr(writing, "exchange", exchanged)
    with pytest.raises(SaveError, match="another program is writing it"):
        save(path, b"new", expected=digest_of(b"old"))
    assert os.lstat(path).st_ino == calls[0]
    assert list(tmp_path.iterdir()) == [path]


def test_interrupted_look_at_what_was_replaced_puts_it_back(tmp_path, monkeypatch, system):
    def interrupted(_):
        raise KeyboardInterrupt

    path = tmp_path / "a"
    path.write_bytes(b"old")
    monkeypatch.setattr(writing, "is_being_written", interrupted)
    if system == "neither":
        return  # nothing is kept that could be looked at
    with pytest.raises(KeyboardInterrupt):
        save(path, b"new", expected=digest_of(b"old"))
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_failed_rename_leaves_no_second_name(tmp_path, monkeypatch):
    def refused(*_):
        raise OSError(errno.EPERM, "Operation not permitted")

    path = tmp_path / "a"
    path.write_bytes(b"old")
    monkeypatch.setattr(writing, "exchange", lambda *_: False)
    monkeypatch.setattr(os, "replace", refused)
    with pytest.raises(SaveError, match=r"a: Operation not permitted$"):
        save(path, b"new", expected=digest_of(b"old"))
    assert list(tmp_path.iterdir()) == [path]
    assert path.stat().st_nlink == 1


def test_second_name_of_a_save_is_no_hard_link_for_another(tmp_path, monkeypatch):
    path = tmp_path / "a"
    path.write_bytes(b"old")
    errors = []

    def other():
        try:
            save(path, b"other", expected=digest_of(b"old"))
        except SaveError as error:
            errors.append(type(error))

    threads = [threading.Thread(target=other)]

    def linked(*arguments):
        link(*arguments)
        threads[0].start()
        time.sleep(0.05)

    link = os.link
    monkeypatch.setattr(writing, "exchange", lambda *_: False)
    monkeypatch.setattr(os, "link", linked)
    save(path, b"new", expected=digest_of(b"old"))
    threads[0].join()
    assert errors == [ChangedError]
    assert path.read_bytes() == b"new"


def test_new_file_takes_no_name_that_is_taken(tmp_path, system):
    path = tmp_path / "film.mp4"
    with path.open("wb") as file:
        file.truncate(2**31)  # is not read
    with pytest.raises(TakenError, match="it is there already"), replacement(path, new=True):
        pytest.fail("nothing is computed")
    path.unlink()
    with pytest.raises(TakenError), replacement(path, new=True) as file:
        file.write(b"ours")
        path.write_bytes(b"theirs")
    assert path.read_bytes() == b"theirs"
    path.unlink()
    with replacement(path, new=True) as file:
        file.write(b"ours")
    assert path.read_bytes() == b"ours"
    assert list(tmp_path.iterdir()) == [path]


SAVER = """
import sys
from pathlib import Path
from distal.file_writer import *
from distal.file_writer import writing

if sys.argv[3] != "exchange":
    writing.exchange = lambda *_: False
path, count, name = Path(sys.argv[1]), 0, sys.argv[2]
sys.stdin.readline()
while count < 60:
    expected = digest_of(path.read_bytes())
    try:
        written = save(path, f"{name} {count}".encode(), expected=expected)
    except ChangedError:
        continue
    assert written.other is None
    count += 1
    print(expected, written.digest)
"""


def saved_in_one_line_of_succession(rows, first, last):
    """Assert that of those who saved over the same text exactly one succeeded."""
    by_expected = dict(rows)
    assert len(by_expected) == len(rows)
    for _ in rows:
        first = by_expected[first]
    assert first == last


@pytest.mark.parametrize("sort", ["exchange", "links"])
def test_one_of_two_processes_is_told_that_it_has_saved(tmp_path, sort):
    path = tmp_path / "a"
    path.write_bytes(b"first")
    savers = [
        subprocess.Popen(
            [sys.executable, "-c", SAVER, path, str(name), sort],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        for name in range(2)
    ]
    for saver in savers:
        saver.stdin.write("\n")
        saver.stdin.flush()
    rows = []
    for saver in savers:
        rows += [line.split() for line in saver.communicate(timeout=60)[0].splitlines()]
        assert saver.returncode == 0
    assert len(rows) == 120
    saved_in_one_line_of_succession(rows, digest_of(b"first"), digest_of(path.read_bytes()))
    assert list(tmp_path.iterdir()) == [path]


def test_one_of_two_threads_is_told_that_it_has_saved(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(b"first")
    rounds, rows = threading.Barrier(2), []

    def saver(name):
        for i in range(120):
            rounds.wait()
            expected = digest_of(path.read_bytes())
            rounds.wait()
            try:
                written = save(path, f"{name} {i}".encode(), expected=expected)
            except ChangedError:
                continue
            rows.append((expected, written.digest))

    threads = [threading.Thread(target=saver, args=(name,)) for name in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(rows) == 120
    saved_in_one_line_of_succession(rows, digest_of(b"first"), digest_of(path.read_bytes()))


# Locks and temporary files

HOLDER = """
import sys
from pathlib import Path
from distal.file_writer.locks import locked
from distal.file_writer.temporary import create, temporary_path

with locked(Path(sys.argv[1]) / sys.argv[2]):
    create(temporary_path(Path(sys.argv[1])), 0o600)
    print("ready", flush=True)
    sys.stdin.readline()
"""


@contextmanager
def held(folder, name="a", **environment):
    command = [sys.executable, "-c", HOLDER, str(folder), name]
    holder = subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, **environment},
    )
    try:
        assert holder.stdout.readline() == "ready\n"
        yield holder
    finally:
        holder.kill()
        holder.communicate()


def test_wait_for_another_process_has_an_end(tmp_path, monkeypatch):
    monkeypatch.setattr(locks, "LONGEST_WAIT_S", 0.05)
    with held(tmp_path) as holder:
        with pytest.raises(SaveError, match=r"^cannot write .*a: another process is writing it$"):
            write(tmp_path / "a")
        write(tmp_path / "b")
        holder.kill()
        holder.wait()
        write(tmp_path / "a")
    temporary.remove_leftovers(tmp_path, at_once=True)
    assert sorted(os.listdir(tmp_path)) == ["a", "b"]


def test_temporary_files_of_the_dead_are_removed_and_no_others(tmp_path, monkeypatch):
    with held(tmp_path, "b"):
        live = set(os.listdir(tmp_path))
        (tmp_path / ".distal-mine.tmp").touch()
        with held(tmp_path, "c"):
            (dead,) = set(os.listdir(tmp_path)) - live - {".distal-mine.tmp"}
        own = temporary.temporary_path(tmp_path)
        own.touch()
        (tmp_path / dead.replace(dead[8:16], "0123abcd")).touch()  # of another machine
        link, of_another = (
            tmp_path / f"{dead[:-5]}{digit}.tmp"
            for digit in sorted(set("012") - {dead[-5]})[:2]  # a random digit is the last
        )
        link.symlink_to(tmp_path)
        if IS_ROOT:
            of_another.touch()
            os.chown(of_another, NOBODY, NOBODY)
        others = set(os.listdir(tmp_path)) - {dead}
        write(tmp_path / "a")
        assert set(os.listdir(tmp_path)) == others | {"a"}
    own.unlink()
    later = time.time() + 8 * 24 * 3600
    monkeypatch.setattr(time, "time", lambda: later)
    temporary.remove_leftovers(tmp_path, at_once=True)
    left = {name for name in os.listdir(tmp_path) if name.startswith(".distal")}
    assert "0123abcd" not in str(left)
    assert len(left) == (3 if IS_ROOT else 2)  # the person's file, the link, another user's


def test_large_folder_is_searched_once(tmp_path, monkeypatch):
    searched = []
    scandir = os.scandir
    monkeypatch.setattr(os, "scandir", lambda path: searched.append(path) or scandir(path))
    for i in range(30):
        write(tmp_path / str(i))
    assert len(searched) == 1


def test_forked_child_is_another_process(tmp_path):
    text = """
import os
from distal.file_writer.locks import is_over, process_name
name = process_name()
read, written = os.pipe()
wait, go_on = os.pipe()
child = os.fork()
if child == 0:
    assert process_name() != name and is_over(*name) is False
    os.write(written, repr(process_name()).encode())
    os.read(wait, 1)
    os._exit(0)
other = eval(os.read(read, 100))
assert other[0] == name[0] and other[1] != name[1]
assert is_over(*other) is False
os.write(go_on, b"x")
os.waitpid(child, 0)
assert is_over(*other) is True and is_over(*name) is False
"""
    command = [sys.executable, "-c", text]
    subprocess.run(command, check=True)


@pytest.mark.parametrize("state", ["/proc/nothing", "/dev/null"])
def test_files_are_written_without_a_folder_of_locks(tmp_path, state):
    with held(tmp_path, "b", XDG_STATE_HOME=state):
        write(tmp_path / "a")
    text = "import sys; from pathlib import Path; from distal.file_writer import *\n"
    text += "save(Path(sys.argv[1]), b'new', expected=digest_of(b'new'))"
    command = [sys.executable, "-c", text, str(tmp_path / "a")]
    environment = {**os.environ, "XDG_STATE_HOME": state}
    subprocess.run(command, env=environment, check=True)
    # Whose process cannot be looked up stays.
    assert len(os.listdir(tmp_path)) == 2


@needs_root
def test_root_makes_no_folder_in_the_home_of_another(shared, monkeypatch):
    os.chown(shared, NOBODY, NOBODY)
    monkeypatch.delenv("XDG_STATE_HOME")
    monkeypatch.setenv("HOME", str(shared))
    with pytest.raises(PermissionError, match=f"{shared} is another user's"):
        state.state_folder()
    os.chown(shared, 0, 0)
    assert state.state_folder() == shared / ".local/state/distal"


def test_state_folder_is_private(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    folder = state.state_folder()
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    folder.parent.chmod(0o775)
    assert state.state_folder() == folder
    folder.chmod(0o720)
    with pytest.raises(PermissionError, match=f"{folder} can be written by others"):
        state.state_folder()


@needs_root
@pytest.mark.parametrize("way", ["folder", "link", "parent"])
def test_state_folder_that_another_user_can_fill_is_not_used(shared, tmp_path, monkeypatch, way):
    """What is in it becomes the text of a scene, which is run."""
    monkeypatch.setenv("XDG_STATE_HOME", str(shared))
    folder = shared / "distal"
    if way == "folder":
        folder.mkdir(mode=0o700)
        os.chown(folder, NOBODY, NOBODY)
    elif way == "link":
        folder.symlink_to(tmp_path)
        os.lchown(folder, NOBODY, NOBODY)
    else:
        shared.chmod(0o777)  # another user renames the folder and makes a new one
    reason = f"{shared} can be" if way == "parent" else f"{folder} is another user's"
    with pytest.raises(PermissionError, match=reason):
        state.state_folder()
