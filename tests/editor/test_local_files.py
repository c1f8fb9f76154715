"""The files of the local studio: what is read, what is saved, what is never overwritten."""

from __future__ import annotations

import os

import pytest

from distal.diagnostics import LoadError
from distal.editor.local.files import SceneFiles
from distal.editor.messages import DiskProblem
from distal.file_writer import digest_of

SCENE = "import parts\nscene = parts.ball\n"


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "scene.py").write_text(SCENE)
    (tmp_path / "parts.py").write_text("import deeper\n")
    (tmp_path / "deeper.py").write_text("x = 1\n")
    (tmp_path / "other.py").write_text("secret = 1\n")
    return tmp_path


def test_the_scene_and_the_modules_that_it_imports_are_read(folder):
    files = SceneFiles(folder / "scene.py")
    assert files.all().files == {
        "scene.py": SCENE,
        "parts.py": "import deeper\n",
        "deeper.py": "x = 1\n",
    }
    assert not files.is_new


def test_a_text_that_is_no_python_is_shown_too(folder):
    (folder / "scene.py").write_text("def (\n")
    assert SceneFiles(folder / "scene.py").all().files == {"scene.py": "def (\n"}


def test_what_other_programs_change_is_told_once(folder):
    files = SceneFiles(folder / "scene.py")
    assert files.read() is None
    (folder / "parts.py").write_text("y = 2\n")
    changed = files.read()
    assert changed is not None
    assert changed.files == {"parts.py": "y = 2\n"}
    assert changed.digests == {"parts.py": digest_of(b"y = 2\n")}
    assert files.read() is None


def test_a_save_replaces_the_text_it_knows(folder):
    files = SceneFiles(folder / "scene.py")
    digest = files.all().digests["scene.py"]
    saved = files.save("scene.py", "new\n", digest)
    assert (folder / "scene.py").read_text() == "new\n"
    assert saved.conflict is None
    assert saved.digest == digest_of(b"new\n")
    assert files.read() is None  # its own change is none


def test_a_change_on_the_disk_is_a_conflict_and_stays(folder):
    files = SceneFiles(folder / "scene.py")
    digest = files.all().digests["scene.py"]
    (folder / "scene.py").write_text("theirs\n")
    saved = files.save("scene.py", "mine\n", digest)
    assert saved.conflict == "theirs\n"
    assert (folder / "scene.py").read_text() == "theirs\n"
    assert files.save("scene.py", "mine\n", saved.digest).conflict is None
    assert (folder / "scene.py").read_text() == "mine\n"


def test_a_new_file_is_there_once_it_is_saved(tmp_path):
    files = SceneFiles(tmp_path / "new.py", {"new.py": "x = 1\n"})
    assert files.is_new
    assert files.all().files == {"new.py": "x = 1\n"}
    assert not list(tmp_path.iterdir())
    assert files.save("new.py", "x = 2\n", "").conflict is None
    assert not files.is_new
    assert (tmp_path / "new.py").read_text() == "x = 2\n"


def test_a_copy_does_not_hide_what_is_on_the_disk(folder):
    files = SceneFiles(folder / "scene.py", {"scene.py": "an example\n"})
    assert files.all().files["scene.py"] == SCENE
    assert files.taken_unsaved() == {"scene.py": "an example\n"}
    assert files.taken_unsaved() == {}
    assert files.save("scene.py", "an example\n", "").conflict == SCENE
    assert (folder / "scene.py").read_text() == SCENE


def test_a_file_that_goes_keeps_its_text(folder):
    files = SceneFiles(folder / "scene.py")
    (folder / "scene.py").unlink()
    digest = files.all().digests["scene.py"]
    changed = files.read()
    assert changed is not None
    assert changed.files == {"scene.py": SCENE}
    assert changed.digests == {"scene.py": digest}
    assert changed.problems == {"scene.py": DiskProblem(digest="", text="was deleted")}
    refused = files.save("scene.py", SCENE, digest)
    assert (refused.is_saved, refused.digest, refused.problem) == (False, "", "was deleted")
    assert files.save("scene.py", SCENE, "").is_saved
    assert (folder / "scene.py").read_text() == SCENE


@pytest.mark.parametrize("text", ["a\r\nb\r\n", "\ufeffa\nb\n"])
def test_line_ends_and_marks_stay(tmp_path, text):
    path = tmp_path / "scene.py"
    path.write_bytes(text.encode())
    files = SceneFiles(path)
    shown = files.all()
    assert shown.files["scene.py"] == "a\nb\n"
    files.save("scene.py", "a\nc\n", shown.digests["scene.py"])
    assert path.read_bytes() == text.replace("b", "c").encode()


@pytest.mark.parametrize(
    "name", ["../out.py", "a/b.py", "/etc/x.py", "scene.txt", "", ".", "..\\x.py"]
)
def test_only_python_files_of_the_folder_are_written(folder, name):
    before = sorted(p.name for p in folder.iterdir())
    files = SceneFiles(folder / "scene.py")
    if name == "..\\x.py" and os.name != "nt":
        files.save(name, "x", "")  # a plain name where a backslash separates nothing
        assert (folder / name).exists()
        return
    with pytest.raises(LoadError, match="is not the name of a Python file"):
        files.save(name, "x", "")
    assert sorted(p.name for p in folder.iterdir()) == before


def test_a_link_out_of_the_folder_is_not_written(folder, tmp_path_factory):
    outside = tmp_path_factory.mktemp("outside") / "target.py"
    outside.write_text("theirs\n")
    (folder / "linked.py").symlink_to(outside)
    files = SceneFiles(folder / "scene.py")
    with pytest.raises(LoadError, match="is not the name of a Python file"):
        files.save("linked.py", "x", digest_of(b"theirs\n"))
    assert outside.read_text() == "theirs\n"


def test_a_file_that_is_no_text_is_refused(tmp_path):
    (tmp_path / "scene.py").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(LoadError, match="is not UTF-8 text"):
        SceneFiles(tmp_path / "scene.py")
