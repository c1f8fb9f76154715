"""The window's state without a window: time, gestures, parameters, pace, files."""

import math
import os
import queue
import threading
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import distal
from distal import Box, Camera, Plane, Scene, Sphere, matte
from distal.lang import Frame, choice, color, image, integer, point, slider, toggle, vec3
from distal.lang.render_options import RenderOptions
from distal.saved_files import FileWatcher
from distal.scene.steering import STILL, Steering
from distal.scene.viewing import interaction
from distal.scene.viewing.key_bindings import BINDINGS, HELP
from distal.scene.viewing.viewable import Viewable, viewable
from distal.window.clock import Clock
from distal.window.dials import Dial, dials
from distal.window.gestures import Mouse, orbited, panned, zoomed
from distal.window.keys import Action, action_of_character, action_of_key
from distal.window.layout import BAR_HEIGHT, Table, time_track
from distal.window.reload import files_in
from distal.window.resolution import STAIRS, ResolutionChooser
from distal.window.session import Session
from distal.window.worker import Worker

LONG_S = 60.0  # for what comes at once; a loaded machine may take seconds

radius = slider("Radius", 1.0, 0.5, 2.0)
count = integer("Count", 3, 1, 9)
tint = color("Tint", (0.5, 0.25, 0.125))


@image
def moving(frame: Frame) -> vec3:
    return vec3(radius * frame.time, float(count), 0.0) * tint


def still_scene() -> Viewable:
    return viewable(Scene(Sphere(radius), camera=Camera((3.0, 2.0, 5.0)), floor=False))


def moving_image() -> Viewable:
    return viewable(moving)


# Time


def test_the_clock_stands_runs_and_changes_speed_without_a_jump() -> None:
    clock = Clock(2.0, running=False, now=100.0)
    assert clock.time(150.0) == 2.0
    clock.run(True, 150.0)
    assert clock.time(151.5) == 3.5
    clock.change_speed(1, 152.0)
    assert clock.time(152.0) == 4.0
    assert clock.time(153.0) == 6.0
    clock.change_speed(-50, 153.0)
    assert clock.time(153.0) == 6.0
    assert clock.time(169.0) == 7.0  # a sixteenth is the slowest
    clock.run(False, 169.0)
    assert clock.time(1e6) == 7.0


def test_a_scene_without_time_does_not_play() -> None:
    session = Session(still_scene())
    assert not session.playing
    session.act(Action.PAUSE, 1.0)
    session.act(Action.FORTH, 2.0)
    assert session.shot(50.0) == Session(still_scene()).shot(0.0)


def test_time_steps_by_keys_and_never_before_the_start() -> None:
    session = Session(moving_image(), paused=True)
    session.act(Action.FORTH, 0.0)
    session.act(Action.FRAME_FORTH, 0.0)
    assert session.shot(9.0).time == pytest.approx(0.25 + 1 / 60)
    assert session.shot(9.0).index == 16
    for _ in range(3):
        session.act(Action.BACK, 0.0)
    assert session.shot(9.0).time == 0.0


def test_the_strip_scrubs_and_its_span_grows_only_when_let_go() -> None:
    session = Session(moving_image(), paused=True)
    session.size = (640.0, 480.0)
    track = time_track(640.0, 480.0)
    session.press(track.x + track.width / 2, 480 - BAR_HEIGHT / 2, 1, 0.0)
    assert session.shot(0.0).time == pytest.approx(5.0)
    session.drag(10_000.0, 470.0, 0.0)
    assert session.shot(0.0).time == 10.0
    session.release(0.0)
    session.act(Action.FORTH, 0.0)
    session.shot(0.0)
    assert session.time_range == (0.0, 20.0)
    ends = [interaction.last_time(t, 0.0, None) for t in (-1.0, 0.0, 10.0, 10.1, 41.0)]
    assert ends == [10, 10, 10, 20, 80]
    assert Session(moving_image(), time=-5.0).time_range == (-5.0, 5.0)


def test_the_time_waits_while_a_hand_holds_the_strip() -> None:
    session = Session(moving_image(), now=0.0)
    track = time_track(640.0, 480.0)
    session.press(track.x + track.width / 2, 480 - BAR_HEIGHT / 2, 1, 1.0)
    assert session.shot(3.0).time == pytest.approx(5.0)
    session.release(4.0)
    assert session.playing
    assert session.shot(5.0).time == pytest.approx(6.0)


# The camera


def test_a_drag_to_the_right_turns_the_eye_to_the_left_and_down_lifts_it() -> None:
    steering = orbited(STILL, 100 / 400, 50 / 400)
    assert steering.yaw == pytest.approx(-math.pi / 4)
    assert steering.pitch == pytest.approx(math.pi / 8)
    back = orbited(steering, -100 / 400, -50 / 400)
    assert (back.yaw, back.pitch) == (pytest.approx(0.0), pytest.approx(0.0))


@pytest.mark.parametrize("elevation", [0.0, 0.7, -1.2, 1.6])
def test_the_eye_never_goes_over_a_pole(elevation: float) -> None:
    highest = orbited(STILL, 0.0, 1e6, elevation).pitch + elevation
    lowest = orbited(STILL, 0.0, -1e6, elevation).pitch + elevation
    assert highest == pytest.approx(max(math.pi / 2 - 0.02, elevation))
    assert lowest == pytest.approx(-(math.pi / 2 - 0.02))


def test_pan_follows_the_pointer_and_zoom_is_bounded() -> None:
    assert panned(STILL, 100 / 400, -50 / 400).pan == (0.5, 0.25)
    assert panned(STILL, 1e9, 1e9).pan == (1000.0, -1000.0)
    assert zoomed(zoomed(STILL, 3.0), -3.0).zoom == pytest.approx(1.0)
    assert zoomed(STILL, -1.0).zoom < 1.0
    far = near = STILL
    for _ in range(9):
        far, near = zoomed(far, 1e9), zoomed(near, -1e9)
    assert (far.zoom, near.zoom) == (64.0, 1 / 64)


def test_what_is_grabbed_follows_the_pointer_on_the_picture() -> None:
    """A sphere's middle, panned by gesture, is where the pointer took it."""
    session = Session(still_scene())
    session.size = (160.0, 120.0)
    session.shows_overlay = False
    session.press(80.0, 60.0, 3, 0.0)
    session.drag(110.0, 45.0, 0.0)
    session.release(0.0)
    shot = session.shot(0.0)
    options = RenderOptions(size=(160, 120))
    depth = session.viewable.render(replace(options, view="material", steering=shot.steering)).array
    rows, columns = np.nonzero(np.abs(depth[..., :3] - depth[0, 0, :3]).max(axis=-1) > 0.05)
    # A sphere beside the middle is drawn out by perspective: a few pixels to the outside.
    assert columns.mean() == pytest.approx(110, abs=4)
    assert rows.mean() == pytest.approx(45, abs=4)


def test_buttons_and_shift_choose_between_orbit_and_pan() -> None:
    for button, shift, pans in ((1, False, False), (1, True, True), (2, False, True)):
        session = Session(still_scene())
        session.press(300.0, 200.0, button, 0.0, shift=shift)
        session.drag(330.0, 200.0, 0.0)
        assert (session.steering.pan != (0.0, 0.0)) is pans
        assert (session.steering.yaw != 0.0) is not pans
    session.act(Action.RESET_CAMERA, 0.0)
    assert session.shot(0.0).steering == STILL


def test_an_image_gets_shadertoys_mouse() -> None:
    session = Session(moving_image(), paused=True)
    session.size = (200.0, 100.0)
    session.press(50.0, 60.0, 1, 0.0)
    assert session.shot(0.0).mouse.pixels((400, 200)) == pytest.approx((100, 80, 100, 80))
    session.frame_begun()
    assert session.shot(0.0).mouse.pixels((400, 200)) == pytest.approx((100, 80, 100, -80))
    session.drag(100.0, 20.0, 0.0)
    assert session.shot(0.0).mouse.pixels((400, 200)) == pytest.approx((200, 160, 100, -80))
    session.release(0.0)
    session.drag(150.0, 20.0, 0.0)
    assert session.shot(0.0).mouse.pixels((400, 200)) == pytest.approx((200, 160, -100, -80))
    assert session.shot(0.0).steering is None
    assert Mouse().pixels((4, 4)) == (0, 0, 0, 0)


def test_equal_states_are_equal_shots() -> None:
    session = Session(still_scene())
    before = session.shot(0.0)
    session.press(300.0, 200.0, 1, 0.0)
    session.drag(310.0, 200.0, 0.0)
    assert session.shot(0.0) != before
    session.drag(300.0, 200.0, 0.0)
    session.release(0.0)
    assert session.shot(99.0) == before
    assert session.is_moving(0.1)
    assert not session.is_moving(1.0)


# Parameters


def rows(*parameters: distal.lang.parameters.Parameter) -> list[Dial]:
    return dials(parameters)


def test_a_row_for_each_number() -> None:
    names = [dial.label for dial in rows(radius, color("Paint"), point("Spot", (0.0, 1.0)))]
    assert names == ["Radius", "Paint r", "Paint g", "Paint b", "Spot x", "Spot y"]


def test_sliders_reach_both_ends_and_steps_are_kept() -> None:
    (dial,) = rows(radius)
    value = 1.0
    for _ in range(200):
        value = dial.moved(value, 1)
    assert value == 2.0
    assert dial.share(value) == 1.0
    assert dial.moved(1.0, 1) == 1.01
    assert dial.moved(1.01, -1) == 1.0
    assert dial.moved(1.0, -1, finely=True) == pytest.approx(0.99925)
    (stepped,) = rows(slider("Stepped", 0.3, 0.0, 1.0, 0.1))
    assert stepped.moved(0.3, 1) == pytest.approx(0.4)
    assert stepped.placed(0.3, 0.77) == pytest.approx(0.8)
    (log,) = rows(slider("Log", 10.0, 1.0, 1000.0, log=True))
    assert log.share(10.0) == pytest.approx(1 / 3)
    assert log.placed(10.0, 1.0) == 1000.0
    assert log.placed(10.0, 0.5) == pytest.approx(31.6)


def test_every_move_gives_a_value_that_the_parameter_takes() -> None:
    every = [
        radius,
        count,
        toggle("Toggle"),
        choice("Choice", ["a", "b", "c"]),
        tint,
        point("Spot"),
        slider("Odd", 0.1, 0.1, 0.7000001),
        integer("Sevens", 0, 0, 50, 7),
        slider("Log", 0.003, 0.003, 0.7, log=True),
    ]
    for dial in rows(*every):
        value = dial.parameter.default
        for step in (1, 1, 1, 60, -1, -99, 7):
            value = dial.parameter.check(dial.moved(value, step))
            share = dial.share(value)
            assert share is None or -1e-9 <= share <= 1 + 1e-9
            assert dial.words(value)
        for share in (0.0, 0.2, 0.9999, 1.0, -3.0, 7.0):
            dial.parameter.check(dial.placed(value, share))


def test_keys_move_the_chosen_row_and_backspace_puts_it_back() -> None:
    session = Session(moving_image(), paused=True)
    session.act(Action.PARAMETERS, 0.0)
    session.act(Action.DOWN, 0.0)
    session.act(Action.RIGHT, 0.0)
    assert session.shot(0.0).parameters == (("count", 4),)
    assert session.shot(0.0).time == 0.0
    session.act(Action.UP, 0.0)
    session.act(Action.LEFT, 0.0)
    assert dict(session.shot(0.0).parameters) == {"count": 4, "radius": 0.9950}
    session.act(Action.RESET_PARAMETER, 0.0)
    assert dict(session.shot(0.0).parameters) == {"count": 4}
    session.act(Action.RESET_PARAMETER, 0.0, shift=True)
    assert session.shot(0.0).parameters == ()


def test_the_pointer_moves_bars_and_does_not_orbit_behind_them() -> None:
    session = Session(still_scene())
    session.size = (640.0, 480.0)
    session.shows_parameters = True
    track = session.table.track(0)
    session.press(track.x + track.width / 3, track.y + 5, 1, 0.0)
    assert session.values == {}
    session.drag(track.x + track.width, track.y + 300, 0.0)
    assert session.values == {"radius": 2.0}
    session.release(0.0)
    session.press(session.table.row(0).x + 2, track.y + 5, 1, 0.0)
    session.drag(400.0, 400.0, 0.0)
    assert session.values == {"radius": 2.0}
    assert session.steering == STILL
    assert session.is_free(600.0, 400.0)
    assert not session.is_free(track.x, track.y + 5)


def test_a_camera_waits_for_its_guide_and_then_goes_where_it_was_asked_to() -> None:
    scene = Scene(Sphere() | Plane(y=-1.0), camera=Camera((0.0, 0.0, 4.0)))
    session = Session(viewable(scene), paused=True, guided=True)
    session.size = (400.0, 400.0)
    session.press(200, 200, 1, 0.0)
    for y in (190, 180, 0):
        session.drag(200, y, 0.0)
    assert session.shot(0.0).steering == STILL
    done = threading.Event()
    session.camera.prepare(session.moment(0.0), done.set)
    assert done.wait(60)
    low = session.shot(0.0).steering
    assert low is not None
    place = session.camera.place(session.moment(0.0))
    assert place is not None
    assert -1.0 < place.position[1] < -0.8
    assert low.pitch < -0.1
    session.act(Action.TOP, 0.0)
    assert session.steering.pitch == pytest.approx(math.pi / 2, abs=1e-3)
    session.act(Action.RESET_CAMERA, 0.0)
    assert session.shot(0.0).steering == STILL


def test_groups_have_headings_that_cannot_be_chosen() -> None:
    radius = slider("Radius", 1.0, 0.2, 2.0)
    softness = slider("Softness", 0.05, 0.0, 0.2, group="Blend")
    width = slider("Width", 1.0, 0.5, 2.0)
    tint = color("Tint", "#d07040", group="Look")
    shape = Sphere(radius).union(Box(width), smooth=softness).paint(matte(tint))
    session = Session(viewable(Scene(shape)), paused=True)
    session.size = (640.0, 480.0)
    labels = [line if isinstance(line, str) else line.label for line in session.lines]
    assert sorted(labels) == sorted(
        ["Radius", "Width", "Blend", "Softness", "Look", "Tint r", "Tint g", "Tint b"]
        + [""] * labels.count("")
    )
    assert labels[labels.index("Blend") + 1] == "Softness"
    assert abs(labels.index("Radius") - labels.index("Width")) == 1
    session.act(Action.PARAMETERS, 0.0)
    heading = session.table.row(labels.index("Look"))
    session.press(heading.x + 2, heading.y + 2, 1, 0.0)
    assert session.dials[session.chosen].label != "Look"
    row = session.table.row(labels.index("Tint g"))
    session.press(row.x + 2, row.y + 2, 1, 0.0)
    session.release(0.0)
    assert session.dials[session.chosen].label == "Tint g"
    assert session.dials[session.chosen].swatch(session.value(session.dials[session.chosen])) == (
        208,
        112,
        64,
    )


def test_a_long_table_scrolls_to_the_chosen_row() -> None:
    for chosen in (0, 7, 40, 99):
        table = Table.of(640.0, 300.0, 100, chosen)
        assert table.first <= chosen < table.first + table.count
        assert table.frame.y + table.frame.height <= 300 - BAR_HEIGHT
        row = table.row(chosen)
        assert table.row_at(row.x + 1, row.y + 1) == chosen
    assert Table.of(640.0, 300.0, 0, 0).row_at(20.0, 60.0) is None


# Another scene in the old one's place


def test_a_new_scene_keeps_what_is_still_valid() -> None:
    session = Session(moving_image(), values={"radius": 1.9, "count": 9}, paused=True, time=3.0)
    session.act(Action.NEXT_VIEW, 0.0)
    view = session.view
    narrower = slider("Radius", 1.0, 0.5, 1.5)

    @image
    def edited(frame: Frame) -> vec3:
        return vec3(narrower * frame.time, float(count), 0.0)

    session.adopt(viewable(edited), 0.0)
    assert session.values == {"count": 9}
    assert session.shot(5.0).time == 3.0
    assert session.view == view
    session.adopt(still_scene(), 0.0)
    session.camera.steering = Steering(yaw=1.0)
    session.act(Action.LAST_VIEW, 0.0)
    assert session.view in session.viewable.views
    session.adopt(still_scene(), 0.0)
    assert session.steering == Steering(yaw=1.0)
    assert session.values == {}


def test_a_value_at_its_default_follows_the_edited_default() -> None:
    session = Session(still_scene())
    session.shows_parameters = True
    session.act(Action.RIGHT, 0.0)
    session.act(Action.LEFT, 0.0)
    assert session.values == {}


# Files


def test_a_save_is_noticed_once_and_only_at_rest(tmp_path: Path) -> None:
    file, other = tmp_path / "a.py", tmp_path / "b.py"
    file.write_text("1")
    watch = FileWatcher([file, other])
    assert not watch.has_changed()
    file.write_text("12")
    assert not watch.has_changed()  # still being written, for all we know
    file.write_text("123")
    assert not watch.has_changed()
    assert watch.has_changed()
    assert not watch.has_changed()
    file.unlink()
    assert not watch.has_changed()
    assert watch.has_changed()
    other.write_text("it comes")
    assert [watch.has_changed(), watch.has_changed()] == [False, True]


def test_an_editor_that_saves_by_renaming_is_noticed(tmp_path: Path) -> None:
    file, fresh = tmp_path / "a.py", tmp_path / "a.tmp"
    file.write_text("1")
    watch = FileWatcher([file])
    fresh.write_text("2")
    stamp = file.stat().st_mtime_ns
    fresh.replace(file)
    os.utime(file, ns=(stamp, stamp))
    assert [watch.has_changed(), watch.has_changed()] == [False, True]


def test_watching_anew_misses_nothing_that_was_saved_meanwhile(tmp_path: Path) -> None:
    file, other = tmp_path / "a.py", tmp_path / "b.py"
    file.write_text("1")
    other.write_text("1")
    watch = FileWatcher([file])
    file.write_text("saved while the scene was loaded")
    watch.watch([file, other])
    assert [watch.has_changed(), watch.has_changed()] == [False, True]


def test_a_broken_neighbor_is_watched_too(tmp_path: Path) -> None:
    scene = tmp_path / "scene.py"
    scene.write_text("import broken\n")
    for text in ("x = (\n", "x = missing\n"):
        (tmp_path / "broken.py").write_text(text)
        with pytest.raises(distal.LoadError) as raised:
            distal.load(scene)
        assert tmp_path / "broken.py" in files_in(raised.value, scene)
    (tmp_path / "broken.py").unlink()
    with pytest.raises(distal.LoadError) as raised:
        distal.load(scene)
    assert tmp_path in files_in(raised.value, scene)


# Frames


def test_frames_get_coarse_enough_while_something_moves_and_sharp_after() -> None:
    size = (640, 480)
    pace = ResolutionChooser()
    assert pace.share(size, is_moving=False) == 0.125
    pace.learn(0.004, 80 * 60)  # 0.26 s for all: a third of the width comes in time
    assert pace.share(size, is_moving=False) == 1.0
    assert pace.share(size, is_moving=True) == 0.35
    for _ in range(20):
        pace.learn(0.001, 640 * 480)
    assert pace.share(size, is_moving=True) == 1.0
    # A quarter of the width can be read: it is kept until a frame takes a quarter second.
    pace.learn(7.0, 640 * 480)
    assert pace.share(size, is_moving=True) == 0.25
    pace.learn(100.0, 640 * 480)
    assert pace.share(size, is_moving=True) == 0.125


def test_a_slow_still_is_preceded_by_a_preview() -> None:
    pace = ResolutionChooser()
    pace.learn(0.1, 640 * 480)
    assert pace.share((640, 480), is_moving=False, is_first=True) == 1.0
    pace.learn(10.0, 640 * 480)
    assert pace.share((640, 480), is_moving=False, is_first=True) == 0.5
    assert pace.share((640, 480), is_moving=False) == 1.0


def test_the_pace_does_not_waver_between_two_shares() -> None:
    pace = ResolutionChooser()
    (_, budget), (below, _) = STAIRS[:2]
    pace.learn(budget * 1.1, 100 * 100)
    assert pace.share((100, 100), is_moving=True) == below
    for _ in range(10):
        pace.learn(budget * 0.9, 100 * 100)
        assert pace.share((100, 100), is_moving=True) == below


def test_the_worker_keeps_order_tells_errors_and_can_be_left() -> None:
    posted: list[object] = []
    told: list[object] = []
    arrived = threading.Semaphore(0)

    def post(call: object) -> None:
        posted.append(call)
        arrived.release()

    worker = Worker(post)  # type: ignore[arg-type]
    worker.submit(lambda _: 1, told.append)
    worker.submit(lambda _: 1 / 0, told.append)
    running = threading.Event()
    worker.submit(lambda cancel: running.set() or cancel.wait(LONG_S), told.append)
    for _ in range(2):
        assert arrived.acquire(timeout=LONG_S)
    assert running.wait(LONG_S)
    worker.cancel()
    assert arrived.acquire(timeout=LONG_S)
    assert told == []  # nothing is done in the worker's own thread
    for call in posted:
        call()  # type: ignore[operator]
    assert told[0] == 1
    assert isinstance(told[1], ZeroDivisionError)
    assert told[2] is True
    assert worker.waiting == 0
    stuck, begun = threading.Event(), threading.Event()
    worker.submit(lambda _: begun.set() or stuck.wait(LONG_S), told.append)
    assert begun.wait(LONG_S)
    assert not worker.stop(0.1)
    stuck.set()


def test_what_was_saved_while_the_window_opened_is_seen(tmp_path: Path) -> None:
    file, other = tmp_path / "scene.py", tmp_path / "parts.py"
    for path in (file, other):
        path.write_text("1")
    began = time.time_ns()
    os.utime(other, ns=(began - 10**9, began - 10**9))
    os.utime(file, ns=(began + 10**9, began + 10**9))
    watch = FileWatcher([file, other], began)
    assert watch.has_changed()
    assert not watch.has_changed()
    assert not FileWatcher([other], began).has_changed()
    assert not FileWatcher([file]).has_changed()


def test_a_job_that_waits_is_cancelled_too() -> None:
    """A file was saved while its first picture, which never ended, waited behind a compiler."""
    posted: queue.SimpleQueue[Any] = queue.SimpleQueue()
    told: list[object] = []
    worker = Worker(posted.put)
    compiled = threading.Event()
    worker.submit(lambda _: compiled.wait(LONG_S), told.append)
    worker.submit(lambda cancel: cancel.wait(LONG_S), told.append)
    worker.cancel()
    worker.submit(lambda cancel: cancel.is_set(), told.append)
    compiled.set()
    for _ in range(3):
        posted.get(timeout=LONG_S)()
    assert told == [True, True, False]
    assert worker.stop(LONG_S)


def test_the_worker_leaves_a_job_that_never_ends() -> None:
    posted: queue.SimpleQueue[Any] = queue.SimpleQueue()
    told: list[object] = []
    worker = Worker(posted.put)
    stuck, begun = threading.Event(), threading.Event()
    left: list[threading.Thread] = []

    def endless(_: threading.Event) -> None:
        left.append(threading.current_thread())
        begun.set()
        stuck.wait(LONG_S)

    worker.submit(endless, told.append)
    worker.submit(lambda _: "after it", told.append)
    assert begun.wait(LONG_S)  # a job that has not begun is not left: the new thread runs it
    worker.abandon()
    worker.submit(lambda _: "new", told.append)
    for _ in range(2):
        posted.get(timeout=LONG_S)()
    assert told == ["after it", "new"]
    assert worker.waiting == 0
    assert not worker.stop(0.1)  # the thread that was left still runs
    stuck.set()
    left[0].join(LONG_S)
    assert posted.empty()  # what the thread that was left made is posted nowhere
    assert worker.stop(LONG_S)


# Keys


def test_every_action_has_a_key_and_a_line_of_the_help() -> None:
    found = set()
    for binding in BINDINGS:
        for key in (*binding.keys, *binding.window_keys):
            action = action_of_key(key) or action_of_character(key)
            assert action is Action(binding.action)
            found.add(action)
            if binding.opposite is not None:
                opposite = action_of_key(key, modified=True)
                assert opposite is Action(binding.opposite)
                found.add(opposite)
    assert found == set(Action)
    assert action_of_character("R") is Action.RESET_CAMERA
    assert action_of_character("V") is Action.LAST_VIEW
    assert action_of_key("v") is None  # it comes as a character too
    told = " ".join(line.keys for line in HELP).lower()
    named = [key.removeprefix("Arrow") for b in BINDINGS for key in b.keys if key.isalpha()]
    arrows = {"Left", "Right", "Up", "Down"}
    assert [key for key in named if key not in arrows and key[:3].lower() not in told] == []
