"""Encodings of scene files: as Python reads them, in every reader, and kept in the studio."""

import ast
import os
import random
import subprocess
import sys
from pathlib import Path

import pytest

from distal import CompileError, LoadError, Scene, load
from distal.diagnostics import readable
from distal.editor.local.files import SceneFiles
from distal.lang import Texture2D
from distal.loading import digest_of
from distal.source_text import SourceTextError, decoded, encoded, has_mark, lines_of

BODY = "from distal import *\nname = 'größe'\nscene = Scene(Sphere(0.8).named(name))\n"
FAULT = "from distal import *\nname = 'größe'; scene = Scene(Sphere(radus=1))\n"
MARK = b"\xef\xbb\xbf"
FORMS = {
    "plain": lambda text: text.encode(),
    "mark": lambda text: MARK + text.encode(),
    "mark and line": lambda text: MARK + f"# coding: utf-8\n{text}".encode(),
    "latin": lambda text: f"# -*- coding: latin-1 -*-\n{text}".encode("latin-1"),
    "second line": lambda text: f"#!/bin/x\n# vim: fileencoding=cp1252 :\n{text}".encode("cp1252"),
    "windows": lambda text: MARK + text.replace("\n", "\r\n").encode(),
}


@pytest.mark.parametrize("form", FORMS)
def test_a_file_runs_and_its_errors_are_at_the_right_columns(tmp_path, form):
    file = tmp_path / "s.py"
    file.write_bytes(FORMS[form](BODY))
    assert isinstance(load(file), Scene)
    digest_of(file)
    file.write_bytes(FORMS[form](FAULT))
    with pytest.raises((CompileError, LoadError)) as caught:
        load(file)
    (found,) = caught.value.diagnostics
    first = FORMS[form]("").count(b"\n")
    assert found.span.line == first + 2
    assert found.span.text.rstrip() == FAULT.split("\n")[1]
    assert found.span.text[found.span.col :].startswith(("Sphere(radus", "radus"))


@pytest.mark.parametrize("form", FORMS)
def test_a_module_beside_the_scene_has_its_own_encoding(tmp_path, form):
    (tmp_path / "beside.py").write_bytes(FORMS[form]("name = 'größe'\n"))
    (tmp_path / "s.py").write_text("from distal import *\nfrom beside import name\n" + BODY[21:])
    assert "größe" in repr(load(tmp_path / "s.py").subject)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (BODY.encode("utf-16"), "is text in UTF-16; save it as UTF-8"),
        (BODY.encode("utf-32"), "is text in UTF-32; save it as UTF-8"),
        (BODY.encode("latin-1"), "is not text in UTF-8"),
        (b"# coding: ascii\n" + BODY.encode(), "is not text in ascii"),
        (b"# coding: foo\n", "names an unknown encoding: foo"),
        (b"# coding: rot13\n", "names 'rot13', which is no encoding of text"),
        (MARK + b"# coding: latin-1\n", "has a byte order mark of UTF-8 and names another"),
    ],
)
def test_what_python_does_not_read_is_one_line(tmp_path, data, words):
    file = tmp_path / "s.py"
    file.write_bytes(data)
    for read in (load, digest_of, SceneFiles):
        with pytest.raises(LoadError) as caught:
            read(file)
        assert words in str(caught.value)
        assert "\n" not in str(caught.value)
    # The oracle: Python does not run it either.
    done = subprocess.run([sys.executable, str(file)], capture_output=True)
    assert done.returncode != 0


def test_the_text_is_the_one_that_python_reads():
    random.seed(3)
    letters = "aö€\n \r\x0c#=:'" + "coding" * 2
    names = ["utf-8", "latin-1", "cp1252", "iso-8859-15", "ascii", "koi8-r", "nonsense", "utf_8"]
    compared = 0
    for _ in range(400):
        head = random.choice(["", "\n", "#!x\n", "# c\n", "x\n"])
        line = random.choice(["", f"# coding: {random.choice(names)}\n", "# coding=utf-8\n"])
        body = "".join(random.choices(letters, k=12))
        literal = repr(body.replace("\r", ""))
        text = f"{head if head != 'x' + chr(10) else ''}{line}value = {literal}\n"
        for name in ("utf-8", "latin-1", "cp1252"):
            try:
                data = random.choice([b"", MARK]) + text.encode(name)
            except UnicodeEncodeError:
                continue
            try:
                expected = ast.dump(ast.parse(data))
            except (SyntaxError, ValueError):
                with pytest.raises((SourceTextError, SyntaxError, ValueError)):
                    ast.parse(decoded(data))
                continue
            assert ast.dump(ast.parse(decoded(data))) == expected
            assert decoded(encoded(decoded(data), mark=has_mark(data))) == decoded(data)
            compared += 1
    assert compared > 500


def test_saving_in_the_studio_keeps_mark_encoding_and_ends(tmp_path):
    for form, write in FORMS.items():
        file = tmp_path / "s.py"
        file.write_bytes(write(BODY))
        files = SceneFiles(file)
        shown = files.all()
        text = shown.files["s.py"]
        assert not text.startswith("\ufeff")
        assert "größe" in text
        assert "\r" not in text
        saved = files.save("s.py", text.replace("0.8", "0.9"), shown.digests["s.py"])
        assert saved.conflict is None
        assert file.read_bytes() == write(BODY.replace("0.8", "0.9")), form


def test_a_character_that_the_encoding_lacks_is_refused_before_the_file_changes(tmp_path):
    file = tmp_path / "s.py"
    before = FORMS["latin"](BODY)
    file.write_bytes(before)
    files = SceneFiles(file)
    shown = files.all()
    text = shown.files["s.py"].replace("größe", "半径")
    with pytest.raises(LoadError, match="line 3 that 'iso-8859-1' does not have"):
        files.save("s.py", text, shown.digests["s.py"])
    assert file.read_bytes() == before


def test_a_name_that_contradicts_the_mark_or_is_none_is_written_as_utf_8():
    text = "# coding: latin-1\nname = 'größe'\n"
    assert encoded(text, mark=True) == MARK + text.encode()
    assert (
        encoded(text.replace("latin-1", "nonsense")) == text.replace("latin-1", "nonsense").encode()
    )


def test_lines_are_those_of_python(tmp_path):
    assert lines_of("a\x0c\nb\x85c\u2028d\n") == ["a\x0c\n", "b\x85c\u2028d\n"]
    file = tmp_path / "s.py"
    file.write_text("# \x0c\u2028\nfrom distal import *\nscene = Scene(Sphere(radus=1))\n", "utf-8")
    with pytest.raises((CompileError, LoadError)) as caught:
        load(file)
    assert caught.value.diagnostics[0].span.text == "scene = Scene(Sphere(radus=1))"


def test_a_file_that_changes_the_folder_changes_it_for_its_own_run(tmp_path, monkeypatch):
    here, there = tmp_path / "here", tmp_path / "there"
    here.mkdir()
    there.mkdir()
    monkeypatch.chdir(here)
    for name in (here / "beside.png", there / "only.png"):
        name.write_bytes(b"not read")
    head = f"import os\nos.chdir({str(there)!r})\n"
    Path("s.py").write_text(
        f"{head}from distal.lang import Texture2D\nfrom distal import *\n"
        "near, far = Texture2D('beside.png'), Texture2D('only.png')\n"
        "none = Texture2D('none.png')\nscene = Scene(Sphere(1.0))\nscene_of = (near, far, none)\n"
    )
    seen = []
    monkeypatch.setattr(Texture2D, "__repr__", lambda self: seen.append(self.data) or "")
    Path("s.py").write_text(Path("s.py").read_text() + "[repr(t) for t in scene_of]\n")
    load("s.py")
    assert seen == [str(here / "beside.png"), str(there / "only.png"), "none.png"]
    assert os.getcwd() == str(here)
    Path("s.py").write_text(f"{head}raise ValueError('no')\n")
    with pytest.raises(LoadError, match=r"s\.py:3:1"):
        load("s.py")
    assert os.getcwd() == str(here)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.py", "a.py"),
        ("ü.py", "ü.py"),
        (os.fsencode("ü.py").decode("ascii", "surrogateescape"), "ü.py"),
        (b"\xff\xc3\xbc".decode("utf-8", "surrogateescape"), "\\xffü"),
        ("\ud800", "\\ud800"),
    ],
)
def test_names_of_files_are_unicode(name, text):
    assert readable(name) == text
