"""What the studio keeps: drafts of tabs, versions of files, and what it says where it cannot."""

from __future__ import annotations

import errno
import json
import os
import stat
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from distal.diagnostics import LoadError
from distal.editor.local.drafts import Drafts
from distal.editor.local.files import SceneFiles
from distal.editor.local.keeping import TabKeeping
from distal.editor.local.tab import StudioTab
from distal.editor.local.versions import MOST, RECENT, FileVersion, FileVersions, sweep, to_remove
from distal.editor.messages import DraftRequest, HelloRequest, VersionRequest, VersionsRequest
from distal.file_writer import digest_of
from tests.editor import keeping_sequences
from tests.editor.keeping_sequences import Clock, SilentWorker

SCENE = "x = 1\n"
DIGEST = digest_of(SCENE.encode())
START = datetime(2026, 3, 1, 12, tzinfo=UTC)


@pytest.mark.parametrize("seed", range(12))
def test_nothing_is_lost_in_a_random_sequence(seed):
    keeping_sequences.run(seed)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "scenes").mkdir()
    (tmp_path / "scenes" / "scene.py").write_text(SCENE)
    return tmp_path / "scenes"


def server(folder, clock=None, state=None):
    """The files of a server, with drafts of its own."""
    files = SceneFiles(folder / "scene.py")
    files.keep_in(Drafts(state or folder.parent / "state", folder, clock or Clock()))
    return files


class Tab:
    """A tab, by its requests."""

    def __init__(self, files, before="", is_new=True):
        self.keeping = TabKeeping(files)
        self.greeted = self.ask(HelloRequest, tab=before, is_new=is_new)

    def ask(self, request, **fields):
        answer = self.keeping.answered(request(id=1, revision=1, **fields))[-1]
        return answer.result if answer.kind == "answer" else answer.mistakes[0].message

    def draft(self, text, digest=DIGEST, file="scene.py"):
        return self.ask(DraftRequest, file=file, text=text, digest=digest).unkept

    @property
    def texts(self):
        return {name: draft.text for name, draft in self.greeted.drafts.items()}


def version_texts(files, name="scene.py"):
    versions = files.drafts.versions
    return [version.path.read_text() for version in versions.all(name)]


def test_a_draft_waits_for_the_next_tab_also_of_the_next_server(folder):
    files = server(folder)
    first = Tab(files)
    assert first.texts == {}
    assert first.draft("mine\n") == ""
    assert Tab(files).texts == {}  # it is the first one's, which lives
    first.keeping.end()
    second = Tab(files)
    assert second.texts == {"scene.py": "mine\n"}
    assert second.greeted.drafts["scene.py"].digest == DIGEST
    files.drafts.close()  # as a kill: nothing is written
    assert Tab(server(folder)).texts == {"scene.py": "mine\n"}


def test_two_servers_leave_each_other_alone(folder):
    one, two = server(folder), server(folder)
    first, second = Tab(one), Tab(two)
    first.draft("first\n")
    assert Tab(two).texts == {}
    second.draft("second\n")
    one.drafts.close()
    assert Tab(two).texts == {"scene.py": "first\n"}
    two.drafts.close()
    third = server(folder)
    tab = Tab(third)
    assert tab.greeted.others == ("scene.py",)
    assert {tab.texts["scene.py"], *version_texts(third)} == {"first\n", "second\n", SCENE}


def test_a_page_that_is_loaded_again_gets_its_own_draft(folder):
    files, clock = server(folder), Clock()
    first, second = Tab(files), Tab(files)
    first.draft("first\n")
    second.draft("second\n")
    clock.now += 10
    for tab, text in ((second, "second\n"), (first, "first\n")):
        tab.keeping.end()
        again = Tab(files, before=tab.greeted.tab)
        assert again.greeted.tab == tab.greeted.tab
        assert again.texts == {"scene.py": text}


def test_a_duplicated_tab_is_another_one(folder):
    files = server(folder)
    first = Tab(files)
    second = Tab(files, before=first.greeted.tab)
    assert second.greeted.tab != first.greeted.tab


def test_a_page_that_connects_again_is_the_tab_that_it_was(folder):
    files = server(folder)
    first = Tab(files)
    first.draft("mine\n")
    again = Tab(files, before=first.greeted.tab, is_new=False)  # the first socket is not closed yet
    assert again.greeted.tab == first.greeted.tab
    first.keeping.end()
    assert Tab(files).texts == {}  # the tab lives


def test_a_page_that_connects_again_takes_no_draft_of_others(folder):
    files = server(folder)
    gone, alive = Tab(files), Tab(files)
    gone.draft("gone\n")
    alive.draft("alive\n")
    files.drafts.close()
    files = server(folder)
    again = Tab(files, before=alive.greeted.tab, is_new=False)
    assert again.texts == {"scene.py": "alive\n"}
    assert Tab(files).texts == {"scene.py": "gone\n"}


def test_a_draft_ends_where_the_disk_has_the_text(folder):
    files = server(folder)
    tab = Tab(files)
    tab.draft("mine\n")
    assert files.save("scene.py", "mine\n", DIGEST).is_saved
    tab.draft(None)
    files.drafts.close()
    files = server(folder)
    assert Tab(files).texts == {}
    assert sorted(version_texts(files)) == ["mine\n", SCENE]


def test_what_is_typed_for_a_moment_is_no_version_and_for_a_second_it_is(folder):
    clock = Clock()
    files = server(folder, clock)
    tab = Tab(files)
    for text, seconds in (("a\n", 0.25), ("b\n", 1.0), ("c\n", 0.25), ("d\n", 0.0)):
        tab.draft(text)
        clock.now += seconds
    assert version_texts(files) == ["b\n", SCENE]
    tab.draft(None)  # another text was taken instead
    assert version_texts(files) == ["d\n", "b\n", SCENE]


def test_versions_are_listed_and_read_and_nothing_else(folder):
    clock = Clock()
    files = server(folder, clock)
    tab = Tab(files)
    clock.now += 5
    files.save("scene.py", "y = 2\r\n", DIGEST)
    listed = tab.ask(VersionsRequest, file="scene.py").versions
    assert [(version.why, version.at) for version in listed] == [
        ("saved", 1000 * clock.now),
        ("opened", 1000 * (clock.now - 5)),
    ]
    assert tab.ask(VersionRequest, file="scene.py", version=listed[1].name).text == SCENE
    for name in ("../../scene.py", "", listed[1].name + "x"):
        reason = tab.ask(VersionRequest, file="scene.py", version=name)
        assert reason == f"there is no version '{name}'"
    assert "is not the name of a Python file" in tab.ask(VersionsRequest, file="../x.py")


def test_drafts_are_private(folder):
    files = server(folder)
    Tab(files).draft("mine\n")
    state = folder.parent / "state"
    for path in (state, *state.rglob("*")):
        mode = stat.S_IMODE(path.stat().st_mode)
        assert mode == (0o700 if path.is_dir() else 0o600), path


def test_what_cannot_be_kept_is_said_and_the_save_goes_on(folder):
    blocked = folder.parent / "file"
    blocked.write_text("")
    files = server(folder, state=blocked / "state")
    tab = Tab(files)
    reason = f"Not a directory in {blocked / 'state'}"
    assert tab.greeted.unkept == reason
    assert tab.draft("mine\n") == reason
    saved = files.save("scene.py", "mine\n", DIGEST)
    assert (saved.is_saved, saved.unkept) == (True, reason)
    assert (folder / "scene.py").read_text() == "mine\n"


def test_a_full_disk_hides_no_draft(folder, monkeypatch):
    files = server(folder)
    tabs = [Tab(files), Tab(files)]
    for number, tab in enumerate(tabs):
        tab.draft(f"{number}\n")
    for tab in tabs:
        tab.keeping.end()

    def full(self, name, data, why):
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(FileVersions, "keep", full)
        first = Tab(files)
    first.keeping.end()
    second = Tab(files)
    assert first.texts.keys() == {"scene.py"}
    kept = {second.texts["scene.py"], *version_texts(files)}
    assert kept == {"0\n", "1\n", SCENE}


def test_a_new_file_has_its_draft_before_it_is_there(tmp_path):
    def opened():
        files = SceneFiles(tmp_path / "new.py", {"new.py": "starter\n"})
        files.keep_in(Drafts(tmp_path / "state", tmp_path, Clock()))
        return files

    files = opened()
    tab = Tab(files)
    assert tab.texts == {}  # the text that it begins with is that of the file
    tab.draft("mine\n", "", "new.py")
    files.drafts.close()
    files = opened()
    assert Tab(files).greeted.drafts["new.py"].text == "mine\n"
    assert not (tmp_path / "new.py").exists()


def test_a_copy_over_a_file_is_a_draft_of_the_first_tab(folder):
    files = SceneFiles(folder / "scene.py", {"scene.py": "an example\n"})
    files.keep_in(Drafts(folder.parent / "state", folder, Clock()))
    tab = Tab(files)
    assert tab.greeted.drafts["scene.py"].text == "an example\n"
    assert tab.greeted.drafts["scene.py"].digest == ""
    assert Tab(files).texts == {}
    tab.keeping.end()
    assert Tab(files).texts == {"scene.py": "an example\n"}


def test_a_draft_of_a_module_that_is_not_imported_comes_with_its_file(folder):
    (folder / "parts.py").write_text("theirs\n")
    files = server(folder)
    Tab(files).draft("mine\n", digest_of(b"theirs\n"), "parts.py")
    files.drafts.close()
    files = server(folder)
    told, greeted = TabKeeping(files).answered(HelloRequest(id=1, revision=1))
    assert told.files == {"parts.py": "theirs\n"}
    assert greeted.result.drafts["parts.py"].text == "mine\n"


# The disk


def test_a_scene_that_is_a_link_is_edited_where_it_leads(folder, tmp_path):
    (tmp_path / "elsewhere").mkdir()
    target = tmp_path / "elsewhere" / "real.py"
    target.write_text("real = 1\n")
    (folder / "linked.py").symlink_to(target)
    files = SceneFiles(folder / "linked.py")
    saved = files.save("linked.py", "real = 2\n", files.all().digests["linked.py"])
    assert saved.is_saved
    assert (folder / "linked.py").is_symlink()
    assert target.read_text() == "real = 2\n"


def test_a_module_that_becomes_a_link_out_of_the_folder_is_not_read(folder, tmp_path):
    (folder / "scene.py").write_text("import parts\n")
    (folder / "parts.py").write_text("inside = 1\n")
    (tmp_path / "secret.py").write_text("secret = 1\n")
    files = server(folder)
    (folder / "parts.py").unlink()
    (folder / "parts.py").symlink_to(tmp_path / "secret.py")
    changed = files.read()
    assert changed.files == {"parts.py": "inside = 1\n"}
    assert changed.problems["parts.py"].text == "leads out of the folder"
    assert all("secret" not in text for text in version_texts(files, "parts.py"))


@pytest.mark.parametrize(
    ("change", "problem", "digest"),
    [
        (lambda p: p.unlink(), "was deleted", ""),
        (lambda p: p.rename(p.with_name("moved.py")), "was renamed to moved.py", ""),
        (lambda p: (p.unlink(), p.mkdir()), "is a folder", "?"),
        (lambda p: (p.unlink(), os.mkfifo(p)), "cannot be read: it is no ordinary file", "?"),
        (lambda p: p.write_bytes(b"\xff\xfe\x00x"), "is text in UTF-16; save it as UTF-8", None),
        (lambda p: (p.unlink(), p.symlink_to("no")), "is a link to a file that is not there", "?"),
    ],
)
def test_what_is_wrong_with_a_file_is_told_and_its_text_stays(folder, change, problem, digest):
    files, path = server(folder), folder / "scene.py"
    before = files.all().digests["scene.py"]
    change(path)
    changed = files.read()
    assert changed.files == {"scene.py": SCENE}
    assert changed.digests == {"scene.py": before}
    told = changed.problems["scene.py"]
    expected = digest_of(b"\xff\xfe\x00x") if digest is None else digest
    assert (told.text, told.digest) == (problem, expected)
    assert files.read() is None
    if digest == "?":
        with pytest.raises(LoadError, match=f"scene.py is not saved: what is there now {problem}"):
            files.save("scene.py", "mine\n", before)
        return
    refused = files.save("scene.py", "mine\n", before)
    assert (refused.is_saved, refused.problem) == (False, problem)
    assert files.save("scene.py", "mine\n", told.digest).is_saved
    assert path.read_text() == "mine\n"
    if digest is None:
        kept = [version.path.read_bytes() for version in files.drafts.versions.all("scene.py")]
        assert b"\xff\xfe\x00x" in kept


@pytest.mark.skipif(os.name == "nt" or os.geteuid() == 0, reason="this user may read every file")
def test_a_file_that_may_not_be_read_is_told(folder):
    files = server(folder)
    (folder / "scene.py").chmod(0)
    told = files.read().problems["scene.py"]
    assert (told.text, told.digest) == ("cannot be read: Permission denied", "?")


def test_a_file_of_two_names_is_written_in_place_if_one_says_so(folder):
    os.link(folder / "scene.py", folder / "twin.py")
    files = server(folder)
    digest = files.all().digests["scene.py"]
    refused = files.save("scene.py", "mine\n", digest)
    assert not refused.is_saved
    assert "2 names (hard links)" in refused.refusal
    assert (folder / "scene.py").read_text() == SCENE
    assert files.save("scene.py", "mine\n", digest, in_place=True).is_saved
    assert (folder / "twin.py").read_text() == "mine\n"
    assert SCENE in version_texts(files)


def test_a_conflict_that_a_save_finds_is_told_to_the_other_tabs(folder):
    files = server(folder)
    (folder / "scene.py").write_text("theirs\n")
    assert files.save("scene.py", "mine\n", DIGEST).conflict == "theirs\n"
    assert files.read().files == {"scene.py": "theirs\n"}
    assert files.read() is None


def test_the_order_of_messages_grows_with_what_is_seen(folder):
    files = server(folder)
    orders = [files.all().order]
    (folder / "scene.py").write_text("theirs\n")
    orders.append(files.read().order)
    orders.append(files.save("scene.py", "mine\n", digest_of(b"theirs\n")).order)
    assert orders == sorted(set(orders))


def test_a_save_is_told_to_the_other_tabs_with_its_order(folder):
    told, sent = [], []
    files = server(folder)
    tab = StudioTab(files, sent.append, saved=told.append, start=SilentWorker)
    request = {"kind": "save", "id": 1, "revision": 1, "file": "scene.py", "text": "mine\n"}
    tab.received(json.dumps({**request, "digest": DIGEST}))
    tab.end()
    answer = json.loads(sent[0])["result"]
    assert told[0].files == {"scene.py": "mine\n"}
    assert told[0].order == answer["order"]


# Versions


def version(at: datetime, why: str = "saved", size: int = 10) -> FileVersion:
    return FileVersion(Path("x"), at.timestamp(), why, "d", size)


def kept(ages, why="saved"):
    """The ages, in hours, of the versions that are left of those of some ages."""
    versions = [version(START - timedelta(hours=age), why) for age in sorted(ages)]
    removed = {id(one) for one in to_remove(versions)}
    return [age for age, one in zip(sorted(ages), versions, strict=True) if id(one) not in removed]


def test_up_to_fifty_versions_all_stay():
    assert kept([i / 100 for i in range(MOST)]) == [i / 100 for i in range(MOST)]


def test_the_last_stay_and_then_one_an_hour_and_one_a_day():
    minutes = [i / 60 for i in range(600)]  # of the last ten hours
    days = [24 * i + 1 for i in range(1, 30)]
    left = kept([*minutes, *days])
    assert len(left) == MOST
    assert left[:RECENT] == minutes[:RECENT]
    assert set(days) <= set(left)

    def hours(ages):
        return {int((START - timedelta(hours=age)).timestamp() // 3600) for age in ages if age < 10}

    assert hours(left) == hours(minutes)


def test_texts_that_were_only_typed_go_first():
    typed = [version(START - timedelta(seconds=i), "typed") for i in range(45)]
    saved = [version(START - timedelta(seconds=100 + i)) for i in range(10)]
    removed = to_remove([*typed, *saved])
    assert {one.why for one in removed} == {"typed"}
    assert len(removed) == 5


def test_bytes_are_bounded_and_the_newest_stays():
    large = [version(START - timedelta(hours=i), size=8_000_000) for i in range(5)]
    assert [one in to_remove(large) for one in large] == [False, False, True, True, True]
    assert to_remove([version(START, size=99_000_000)]) == []


def test_a_text_is_one_version_and_becomes_the_newest(tmp_path):
    clock = Clock()
    versions = FileVersions(tmp_path, clock)
    for text in (b"a\n", b"b\n", b"a\n", b"a\n", b"  \n"):
        versions.keep("scene.py", text, "other")
        clock.now += 1
    assert [one.path.read_bytes() for one in versions.all("scene.py")] == [b"a\n", b"b\n"]


def test_all_folders_together_are_bounded(tmp_path):
    clock = Clock()
    for number in range(6):
        FileVersions(tmp_path / str(number % 2), clock).keep(
            "scene.py", b"#" * (100 + number), "saved"
        )
        clock.now += 1
    sweep(tmp_path, 320)
    left = sorted(path.stat().st_size for path in tmp_path.glob("*/*/versions/*.py"))
    assert left == [103, 104, 105]


def test_a_state_folder_that_cannot_be_used_is_said_and_nothing_is_written(tmp_path, monkeypatch):
    """The reason names a path: nothing is made there."""
    state = tmp_path / "state"
    (state / "distal").mkdir(parents=True)
    (state / "distal").chmod(0o777)
    monkeypatch.setenv("XDG_STATE_HOME", str(state))
    drafts = Drafts.of_user(tmp_path)
    with pytest.raises(OSError, match="Not a directory") as refused:
        drafts.put("0" * 12, "a.py", "x = 1", "")
    assert drafts.reason(refused.value) == f"{state / 'distal'} can be written by others"
    assert sorted(tmp_path.rglob("*")) == [state, state / "distal"]
