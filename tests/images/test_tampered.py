"""Pictures that a stranger made: they name no file that is run, and show no text that is unsafe."""

import io
import json
import os
import struct
import unicodedata
import zlib
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from distal.cli.application import application
from distal.loading import digest_of

SCENE = """\
from distal import Camera, Scene, Sphere
scene = Scene([Sphere(0.7)], camera=Camera((0, 0, 4)))
"""
SIGNATURE = b"\x89PNG\r\n\x1a\n"
NAME_IT = "name it: --source FILE[:NAME]\n"


@pytest.fixture(scope="module")
def base(tmp_path_factory):
    """The chunks of a picture, as distal writes them."""
    folder = tmp_path_factory.mktemp("base")
    (folder / "scene.py").write_text(SCENE)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        words = ("render", "scene.py", "--size", "4x4", "-o", "a.png")
        assert CliRunner().invoke(application, words).exit_code == 0
    return list(chunks((folder / "a.png").read_bytes()))


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Run the command in a folder whose files tell when they are run."""
    folder = tmp_path / "in"
    (folder / "sub").mkdir(parents=True)
    (tmp_path / "out").mkdir()
    (folder / ".hidden").mkdir()
    monkeypatch.chdir(folder)
    evil = f"open({str(tmp_path / 'ran')!r}, 'w')\n{SCENE}"
    for place in (
        *(
            "../out/evil.py",
            ".hidden/evil.py",
            "evil.txt",
            "evil",
            "evil.py.old",
            ".py",
            "..py",
            "evil.py:scene",
        ),
        *("a\\b.py", "C:evil.py", "gro\u202evil.py", "new\nline.py", "\x1b[2Jx.py"),
    ):
        Path(place).write_text(evil)
    Path("scene.py").write_text(SCENE)
    Path("sub/scene.py").write_text(SCENE)
    os.symlink("../out/evil.py", "link.py")
    os.symlink("../out", "linked")
    os.symlink("circle.py", "circle.py")
    os.symlink("sub/scene.py", "near.py")
    os.mkfifo("pipe.py")
    os.mkdir("folder.py")

    def invoke(*words):
        result = CliRunner().invoke(application, words)
        assert not (tmp_path / "ran").exists(), "a file was run that nobody meant"
        assert result.exception is None or isinstance(result.exception, SystemExit)
        for line in result.output.splitlines():
            bad = [c for c in line if unicodedata.category(c) in ("Cc", "Cf", "Cs", "Zl", "Zp")]
            assert not bad, line
        return result

    return invoke


def chunks(data):
    place = len(SIGNATURE)
    while place < len(data):
        length, name = struct.unpack_from(">I4s", data, place)
        yield name, data[place + 8 : place + 8 + length]
        place += length + 12


def built(parts):
    return SIGNATURE + b"".join(
        struct.pack(">I", len(part)) + name + part + struct.pack(">I", zlib.crc32(name + part))
        for name, part in parts
    )


def text_chunk(key, text):
    packed = zlib.compress(text.encode("utf-8", "surrogatepass"))
    return b"iTXt", f"distal:{key}".encode() + b"\0\1\0\0\0" + packed


def with_texts(base, **texts):
    """The picture with other texts."""
    new = {key.replace("_", "-"): text for key, text in texts.items()}
    dropped = {f"distal:{key}".encode() for key in new}
    kept = [part for part in base if part[1].partition(b"\0")[0] not in dropped]
    return built([kept[0], *(text_chunk(*item) for item in new.items()), *kept[1:]])


@pytest.mark.parametrize(
    "source",
    [
        *(
            "../out/evil.py",
            "../out/evil.py:scene",
            "./../out/evil.py",
            "..py",
            ".hidden/evil.py",
            "sub/../../out/evil.py",
        ),
        *("ABSOLUTE", "ABSOLUTE:scene", "/ABSOLUTE", "file://ABSOLUTE"),
        *(
            "evil",
            "evil:scene",
            "evil.txt",
            "evil.txt:scene",
            "evil.py.old",
            ".py",
            "evil.py:scene",
        ),
        *("link.py", "link.py:scene", "linked/evil.py", "circle.py", "pipe.py", "folder.py"),
        *("a\\b.py", "C:evil.py", "C:\\evil.py", "\\\\host\\share\\evil.py", "~/evil.py"),
        *("gro\u202evil.py", "new\nline.py", "\x1b[2Jx.py", "evil.py\0.png", "\udc80.py"),
        *("example:../out/evil", "example:ABSOLUTE", "example:", "example", "example:\x1b[2J"),
        *(
            "",
            ":",
            ":scene",
            "..",
            "/dev/zero",
            "/dev/stdin",
            "a" * 5000 + ".py",
            "x/" * 5000 + "a.py",
        ),
    ],
    ids=lambda source: ascii(source)[:30],
)
def test_file_that_a_picture_must_not_choose(run, base, tmp_path, source):
    evil = str(tmp_path / "out" / "evil.py")
    texts = {"source": source.replace("ABSOLUTE", evil), "source_hash": digest_of(evil)}
    Path("a.png").write_bytes(with_texts(base, **texts, neighbors="[]"))
    for words in ((), ("--force",)):
        result = run("rerender", "a.png", *words)
        assert result.exit_code == 1
        assert result.stderr.startswith("error: cannot rebuild a.png: ")
        assert result.stderr.endswith(NAME_IT) or "there is no example" in result.stderr
        assert result.stderr.count("\n") == 1
        assert len(result.stderr) < 1100


def test_refused_file_is_rendered_where_a_person_names_it(run, base):
    Path("a.png").write_bytes(with_texts(base, source="../out/evil.py"))
    assert run("rerender", "a.png", "--source", "scene.py").exit_code == 0


@pytest.mark.parametrize("source", ["scene.py", "./scene.py:scene", "sub/scene.py", "near.py"])
def test_file_that_a_picture_may_name(run, base, source):
    Path("a.png").write_bytes(with_texts(base, source=source))
    result = run("rerender", "a.png", "--check")
    assert (result.exit_code, result.stdout) == (0, "a.png: identical\n"), result.stderr


DEEP = "[" * 200_000
LONG_NUMBER = "9" * 4000


@pytest.mark.parametrize(
    "texts",
    [
        *({"time": text} for text in ("inf", "1e999", "", "x" * 10**5)),
        *({"size": text} for text in ("nanxnan", "1e9x1e9", "1000000000x1000000000", "4x4\n")),
        *({"samples": text} for text in ("1e9", "1000000000", LONG_NUMBER, "9" * 5000, "nan")),
        *({"index": text} for text in ("9" * 5000, "1e9", "x")),
        *({"mouse": text} for text in ('"abcd"', "[NaN,0,0,0]", "[true,0,0,0]", DEEP, "{}")),
        *(
            {"parameters": text}
            for text in ('{"x\x1b":1}', '{"x":NaN}', '{"x":[[]]}', "null", DEEP)
        ),
        {"parameters": json.dumps({str(i): 1 for i in range(50_000)})},
        *({"neighbors": text} for text in ('"ab"', "[1]", '["\\u0000"]', '["x.py", "x.py"]', DEEP)),
        {"neighbors": json.dumps([f"\x1b{i}.py" for i in range(20_000)])},
        {"neighbors": json.dumps([f"{i}\u202e" * 50 for i in range(2000)])},
        *({"plane": text} for text in ("[[0,0,1]]", '[[0,0,1],"x"]', "[[NaN,0,1],0]", "{}", DEEP)),
        *({"exposure": text} for text in ("nan", "inf", "x", "-1")),
        *({"view": text} for text in ("\x1b]0;x\x07", "x" * 10**5, "local:\x1b", "\u200b")),
        *({"steering": text} for text in ("[]", "[NaN,0,1,0,0]", "[0,0,-1,0,0]", DEEP)),
        *({"stage": text} for text in ("[1,2]", "[{},NaN]", "{}", DEEP)),
        *({key: "\x1b[2J\n"} for key in ("tone_map", "layers", "device", "transparent", "freeze")),
        *({"device": text} for text in ("cpu:x", "x" * 10**5, ":")),
        {"source_hash": "\x1b[2J"},
        {"parameters": "0" * 2**24},
    ],
    ids=lambda texts: ascii(texts)[:40],
)
def test_text_that_is_refused_in_one_line(run, base, texts):
    Path("a.png").write_bytes(with_texts(base, **texts))
    result = run("rerender", "a.png")
    assert result.exit_code == 1
    assert result.stderr.startswith("error: ")
    assert result.stderr.count("\n") == 1
    assert len(result.stderr) < 1100


def test_version_is_shown_safely(run, base):
    Path("a.png").write_bytes(with_texts(base, version="\x1b[2J\u202e" + "9" * 10**5))
    result = run("rerender", "a.png", "--check")
    assert result.exit_code == 0
    assert "was made by distal \\x1b[2J\\u202e999" in result.stderr
    assert len(result.stderr) < 200


def test_broken_files_are_refused_in_one_line(run, base):
    data = built(base)
    head = struct.pack(">IIBBBBB", 10**9, 10**9, 8, 2, 0, 0, 0)
    bomb = b"distal:parameters\0\0" + zlib.compress(b"0" * 2**24)
    broken = [data[:place] for place in range(8, len(data), 41)]
    broken += [
        built([(b"IHDR", head), *base[1:]]),
        built([(b"IHDR", b"\0"), *base[1:]]),
        built([part for part in base if part[0] != b"IDAT"]),
        built([base[0], (b"zTXt", bomb), *base[1:]]),
        built([base[0], *[(b"tEXt", b"distal:source\0../out/evil.py")] * 3, *base[1:-1], base[-1]]),
        built([*base[:-1], (b"tEXt", b"distal:source\0../out/evil.py"), base[-1]]),
    ]
    told = []
    for content in broken:
        Path("a.png").write_bytes(content)
        result = run("rerender", "a.png")
        told.append(result.exit_code)
        assert result.exit_code == 0 or result.stderr.count("\n") == 1
    # Of two texts of one name the last counts: the harmless one that follows in the last but one.
    assert told[-6:] == [1, 1, 1, 1, 0, 1]
    assert set(told[:-6]) == {1}


def test_deep_picture_that_unpacks_to_more_than_it_shows(run):
    run("render", "scene.py", "--size", "4x4", "--bits", "16", "-o", "a.png")
    parts = list(chunks(Path("a.png").read_bytes()))
    bomb = zlib.compress(b"\2" * 2**24)
    changed = [(name, bomb if name == b"IDAT" else part) for name, part in parts]
    Path("a.png").write_bytes(built(changed))
    result = run("rerender", "a.png", "--check")
    assert (result.exit_code, result.stdout.count("differ")) == (1, 1), result.output


@pytest.mark.parametrize(
    "header",
    [
        {"distal:source": "../out/evil.py"},
        {"distal:source": "link.py"},
        {"distal:source": 3},
        {"distal:source": "\x1b[2J\n"},
        {"distal:source": "x" * 10**6 + ".py"},
        {"distal:source": "scene.py", "distal:parameters": "[" * 10**4},
    ],
    ids=lambda header: str(header)[:40],
)
def test_exr_is_held_to_the_same(run, tmp_path, header):
    openexr = pytest.importorskip("OpenEXR", reason="OpenEXR is not installed")
    whole = {
        "compression": openexr.ZIP_COMPRESSION,
        "type": openexr.scanlineimage,
        "distal:source-hash": digest_of(tmp_path / "out" / "evil.py"),
        **header,
    }
    buffer = io.BytesIO()
    with openexr.File(whole, {c: np.zeros((4, 4), np.float16) for c in "RGBA"}) as file:
        file.write(buffer)
    Path("a.exr").write_bytes(buffer.getvalue())
    result = run("rerender", "a.exr", "--force")
    assert result.exit_code == 1
    assert result.stderr.count("\n") == 1
    assert len(result.stderr) < 1100
