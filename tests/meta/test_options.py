"""Each option has one row; methods with their documentation and commands follow from it."""

from __future__ import annotations

import importlib.util
import inspect
import re
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import pytest
import typer
from typer.testing import CliRunner

import distal
from distal.cli.options import FORMS, NOTHING_ASKED, Asked, flag_name, flags, requesting
from distal.export.page_options import PageOptions
from distal.lang import Image
from distal.lang.options import Flag, option, rows
from distal.lang.presentable import Presentable
from distal.lang.render_options import RenderOptions
from distal.scene.objects.field import BaseShape
from distal.scene.scene import Scene

ROOT = Path(__file__).parents[2]
METHODS = {
    "scene": Scene.render,
    "image": Image.render,
    "shape": BaseShape.render,
    "video": Presentable.video,
    "sweep": distal.sweep,
}


def _tool():
    spec = importlib.util.spec_from_file_location("methods", ROOT / "tools/gen_option_methods.py")
    assert spec is not None and spec.loader is not None
    tool = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = tool
    spec.loader.exec_module(tool)
    return tool


TOOL = _tool()


def entries(documented):
    """The entries of ``Args`` of a docstring, by name, with folded white space."""
    text = inspect.getdoc(documented) or ""
    section = text.partition("Args:\n")[2].partition("\n\n")[0]
    found = re.findall(r"^    (\w+): (.*(?:\n {6,}.*)*)", section, re.MULTILINE)
    return {name: " ".join(words.split()) for name, words in found}


@dataclass(frozen=True, slots=True, kw_only=True)
class WithGrain(RenderOptions):
    """The options of a picture, and one that somebody adds: a row, and nothing else."""

    grain: float | None = option(
        None,
        "The strength of the grain.",
        "scene",
        of_paths=True,
        recorded=True,
        flag=Flag(metavar="X"),
    )


def test_generated_methods_are_fresh():
    written = TOOL.FILE.read_text(encoding="utf-8")
    assert written == TOOL.file_text(), "run tools/gen_option_methods.py"


@pytest.mark.parametrize("method", METHODS)
def test_a_method_has_its_rows_in_signature_and_documentation(method):
    parameters = inspect.signature(METHODS[method]).parameters
    documented = entries(METHODS[method])
    assert documented.keys() == parameters.keys() - {"self"}
    for row in rows(RenderOptions, method):
        assert parameters[row.name].default == row.default_of(method)
        assert documented[row.name] == row.doc_of(method)


def test_methods_that_render_have_no_other_options():
    for method in ("scene", "image", "shape"):
        named = [row.name for row in rows(RenderOptions, method)]
        assert ["self", *named] == list(inspect.signature(METHODS[method]).parameters)


def test_every_row_is_documented_and_its_methods_exist():
    for row in rows(RenderOptions):
        assert row.doc.endswith(".")
        assert {*row.methods.split()} <= METHODS.keys() | {"window"}  # a command alone
        others = {*row.docs, *row.defaults}
        others |= {*row.flag.helps} if row.flag else set()
        assert others <= {*row.methods.split()}


def test_exports_and_cells_take_the_options_of_what_makes_them():
    pages = inspect.signature(PageOptions).parameters.keys()
    exported = inspect.signature(Presentable.export).parameters.keys()
    assert exported == pages | {"self", "path", "target"}
    widget = pytest.importorskip("distal.notebook.widget")
    cell = inspect.signature(widget.LiveView).parameters.keys()
    assert inspect.signature(Presentable.show).parameters.keys() - {"self"} == cell - {"obj"}


def test_workers_get_all_options_of_images_but_those_of_a_process():
    whole_pictures = pytest.importorskip("distal.cluster.whole_pictures")
    of_process = {"device", "threads", "progress", "cancel", "cluster"}
    of_each = {"time", "index", "params"}
    of_images = {row.name for row in rows(RenderOptions, "image")}
    assert of_images - of_process - of_each <= set(whole_pictures._SENT)
    assert set(whole_pictures._SENT) <= {row.name for row in rows(RenderOptions)}


def test_an_added_row_is_an_argument_with_its_documentation():
    text = TOOL.render_text(Scene, "scene", WithGrain)
    assert "\n        grain: float | None = None,\n" in text
    assert '\n            grain: In mode "path": the strength of the grain.\n' in text
    assert "\n            grain=grain,\n" in text
    assert "grain" not in TOOL.render_text(Image, "image", WithGrain)


def test_an_added_row_is_an_option_of_the_command():
    application, found = typer.Typer(), {}

    @application.command()
    @requesting("scene", WithGrain)
    def render(asked: Asked = NOTHING_ASKED, stats: Annotated[bool, typer.Option()] = False):
        found.update(asked)

    run = CliRunner().invoke
    assert run(application, ["--grain", "0.3", "--size", "4x3", "--no-caustics"]).exit_code == 0
    defaults = {"time": 0.0, "denoise": False, "transparent": False}
    assert found == {**defaults, "grain": 0.3, "size": (4, 3), "caustics": False}
    assert WithGrain(**found).grain == 0.3
    text = re.sub(r"[^\w.:-]+", " ", run(application, ["--help"], env={"COLUMNS": "200"}).output)
    assert "--grain X In mode path: the strength of the grain." in text


def test_a_command_shows_the_default_that_it_reads():
    for method in ("scene", "video", "sweep"):
        for row in flags(method):
            form = FORMS.get(row.flag.form)
            if form is not None and form.written is not None:
                assert form.read(form.written(row.default_of(method))) == row.default_of(method)


def test_every_form_of_a_row_exists_and_is_used():
    assert {row.flag.form for row in flags("scene")} - {None} == FORMS.keys()


def test_the_switch_that_changes_an_option_is_the_one_that_is_named():
    named = {row.name: flag_name(row) for row in flags("scene")}
    assert named["caustics"] == "--no-caustics"
    assert (named["plane"], named["time_limit"]) == ("--slice", "--time-limit")
