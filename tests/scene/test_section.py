"""A scene cut open by a plane: the same as a shape that its author cuts, and a marked face."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import distal
from distal import Box, Camera, Cylinder, DistantLight, Plane, Scene, Sphere, matte
from distal.lang.render_options import RenderOptions
from distal.scene.rerender import plan_rerender, rerender
from distal.scene.section import CutPlane
from distal.scene.steering import STILL, Steering
from distal.scene.viewing.guide import Moment
from distal.scene.viewing.viewable import viewable
from distal.window.section_plane import SectionPlane

OPTIONS = RenderOptions(size=(64, 48), samples=1)
NORMAL = (0.6, 0.0, 0.8)


def parts():
    bored = (Box(1.6, 1.2, 1.4) - Cylinder(0.3, 3.0)).paint(matte("#c04020"))
    return bored, Sphere(0.5).translate(y=0.9).paint(matte("#2050c0"))


def part():
    bored, ball = parts()
    return bored | ball


def scene(shape) -> Scene:
    lights = [DistantLight((0.3, 1.0, 0.6))]
    return Scene([shape, Plane(y=-0.6)], lights, Camera((2.0, 1.5, 3.5), (0.0, 0.2, 0.0)))


@pytest.mark.sample(2, each="view")
@pytest.mark.parametrize("view", ["color", "normal", "depth"])
@pytest.mark.parametrize("offset", [-0.3, 0.1, 9.0])
def test_a_section_without_lines_is_the_shape_that_its_author_cuts(view: str, offset: float):
    seen = viewable(scene(part()))
    found = seen.render(replace(OPTIONS, view=view, section=CutPlane(NORMAL, offset))).array
    bored, ball = (solid.split(NORMAL, offset)[0] for solid in parts())
    author = scene(bored | ball if offset < 9.0 else part())
    expected = viewable(author).render(replace(OPTIONS, view=view)).array
    assert np.abs(found - expected).max() < 1e-5
    whole = seen.render(replace(OPTIONS, view=view)).array
    assert (np.abs(found - whole).max() > 0.1) == (offset < 9.0)


def test_a_cut_face_has_the_color_of_its_part_and_lines():
    camera = Camera((0.0, 0.0, 5.0), (0.0, 0.0, 0.0))
    seen = viewable(Scene(Box(2.0, 2.0, 2.0).paint("#c04020"), camera=camera, floor=False))
    plain, lined = (
        seen.render(replace(OPTIONS, section=CutPlane((0.0, 0.0, 1.0), 0.0, hatch))).array[
            24, :, :3
        ]
        for hatch in (0.0, 0.4)
    )
    on_face = plain[32], lined[24:40]
    assert on_face[1][:, 0].min() < 0.8 * on_face[1][:, 0].max()  # lines are darker
    for color in on_face[1]:
        assert color[0] > 1.8 * color[2]  # and of the same color
    beside = seen.render(replace(OPTIONS, section=CutPlane((0.0, 0.0, 1.0), 1.5, 0.4))).array
    assert np.array_equal(
        beside, seen.render(replace(OPTIONS, section=CutPlane((0, 0, 1), 1.5))).array
    )


def test_the_whole_picture_is_not_changed_by_the_cut_program():
    seen = viewable(scene(part()))
    before = seen.render(OPTIONS).array
    assert seen.sectioned is not None
    assert np.array_equal(seen.render(OPTIONS).array, before)
    program = seen.image(encoded=True, steered=True).emitted()
    assert "CutPlane" not in str(program)


def test_a_section_moves_with_the_camera():
    seen = viewable(scene(part()))
    turned = seen.render(
        replace(OPTIONS, steering=Steering(0.5), section=CutPlane(NORMAL, 0.1))
    ).array
    still = seen.render(replace(OPTIONS, steering=STILL, section=CutPlane(NORMAL, 0.1))).array
    assert np.abs(turned - still).max() > 0.1


@pytest.mark.parametrize(
    ("normal", "offset", "hatch", "said"),
    [
        ((0.0, 2.0, 0.0), 0.0, 0.0, "the normal of a section has length 1"),
        ((0.0, 1.0, 0.0), math.nan, 0.0, "a section has finite numbers"),
        ((0.0, 1.0, 0.0), 0.0, -1.0, "hatch is 0 or a distance"),
    ],
)
def test_a_bad_section_is_refused(normal, offset: float, hatch: float, said: str):
    with pytest.raises(ValueError, match=said):
        CutPlane(normal, offset, hatch)


def test_what_cannot_be_cut_says_so():
    assert not viewable(Scene(Plane())).is_sectionable
    terrain = Scene(Sphere(1.0), march="heightfield")
    assert viewable(terrain).sectioned is None


def test_keys_cut_along_each_axis_move_the_plane_and_turn_it():
    shown, moment = scene(Box(2.0, 4.0, 6.0)), Moment()
    plane = SectionPlane()
    assert plane.section(shown, moment) is None
    places = []
    for _ in range(3):
        plane = plane.turned()
        found = plane.section(shown, moment)
        assert found is not None
        assert found.offset == pytest.approx(0.0, abs=1e-6)
        places.append(found.normal)
    assert places == [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
    moved = plane.moved(4).section(shown, moment)
    assert moved is not None
    assert moved.offset == pytest.approx(0.6)  # a tenth of 6
    other = plane.moved(4).other_side()
    turned = other.section(shown, moment)
    assert turned is not None
    assert (turned.normal, turned.offset) == ((0.0, 0.0, -1.0), pytest.approx(-0.6))
    assert other.text(turned) == "section z > 0.6"
    assert plane.moved(99).share == 1.0
    assert plane.turned() == SectionPlane()


def test_a_saved_picture_is_rendered_again_with_its_section(tmp_path: Path):
    file = tmp_path / "part.py"
    file.write_text(
        "from distal import Box, Scene\n\nscene = Scene(Box(2, 1, 1).paint('#c04020'))\n"
    )
    section = CutPlane(NORMAL, 0.25, 0.1)
    made = viewable(distal.load(str(file))).render(replace(OPTIONS, section=section))
    made.save(tmp_path / "cut.png")
    found = plan_rerender(tmp_path / "cut.png", source=str(file))
    assert found.record.provenance.section == section.numbers
    assert np.array_equal(rerender(found).array, made.array)
