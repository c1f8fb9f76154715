"""Textures and buffers as they are declared."""

from __future__ import annotations


def test_a_file_is_found_beside_the_scene(tmp_path, monkeypatch):
    (tmp_path / "photo.png").write_bytes(b"")
    scene = tmp_path / "scene.py"
    monkeypatch.chdir("/")
    text = "from distal.lang import Texture2D, TextureCube\n"
    text += "photo = Texture2D('photo.png')\nother = Texture2D('elsewhere.png')\n"
    text += "sky = TextureCube(['photo.png'] * 6)\n"
    names = {"__file__": str(scene)}
    exec(compile(text, scene, "exec"), names)
    assert names["photo"].data == str(tmp_path / "photo.png")
    assert names["other"].data == "elsewhere.png"
    assert names["sky"].data == [str(tmp_path / "photo.png")] * 6
