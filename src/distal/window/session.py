"""The state of a window: time, camera, parameters, view and the current drag.

Input: a ``Viewable``, actions of keys, pointer events, readings of a monotonic clock. Output: a
``Shot``. Does not depend on displays, devices or threads.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from enum import Enum, auto
from typing import TYPE_CHECKING, Final

from distal.lang.live_textures import Keys
from distal.lang.parameter_values import Value
from distal.scene.section import CutPlane
from distal.scene.steering import Steering
from distal.scene.viewing import interaction
from distal.scene.viewing.guide import Moment
from distal.scene.viewing.viewable import COLOR
from distal.window.clock import Clock
from distal.window.dials import Dial, Line, dials, lines_of, valid_values
from distal.window.gestures import Mouse, on_picture, orbited, panned, zoomed
from distal.window.guided_camera import SHOWN, GuidedCamera
from distal.window.keys import Action
from distal.window.layout import Table, time_bar, time_track
from distal.window.ruler_tool import NEEDS_SOLID, RulerTool, Sight
from distal.window.section_plane import SectionPlane
from distal.window.shot import Shot

if TYPE_CHECKING:
    from distal.scene.viewing.viewable import Viewable

# How long after the last input a picture counts as moving; notches of a wheel come in bursts.
_SETTLING_S: Final = 0.25
_LEFT, _RIGHT, _MIDDLE = 1, 2, 3
# A pointer that moves farther while the button is down drags; else it clicks.
_CLICK: Final = 4.0
_CUTS: Final = (
    *(Action.SECTION, Action.SECTION_SIDE),
    *(Action.SECTION_BACK, Action.SECTION_FORTH),
)
# The directions of the arrow keys: right and up.
_ARROWS: Final = {
    Action.LEFT: (-1, 0),
    Action.RIGHT: (1, 0),
    Action.UP: (0, 1),
    Action.DOWN: (0, -1),
}


class Grab(Enum):
    """What the pointer drags."""

    ORBIT = auto()
    PAN = auto()
    MOUSE = auto()
    TIME = auto()
    DIAL = auto()


class Session:
    """The state of the interaction in a window.

    Attributes:
        viewable: The object to show.
        clock: The scene's time.
        camera: The camera, moved by gestures and keys.
        values: The parameters that a person moved, by name.
        view: The name of the view.
        mode: How light is computed at rest: "direct" or "path"; None: as the scene says.
        plane: How the scene is cut open.
        ruler: The ruler on the scene.
        dials: The controls of the parameters.
        lines: The rows of their table: the controls, and the names of groups.
        chosen: The index of the control that keys move.
        size: The window's width and height in its own units.
        shows_parameters: Whether the parameters are visible.
        shows_help: Whether the help is visible.
        shows_overlay: Whether anything is drawn over the picture.
    """

    def __init__(
        self,
        viewable: Viewable,
        *,
        time: float = 0.0,
        values: Mapping[str, Value] | None = None,
        view: str = "color",
        paused: bool = False,
        guided: bool = False,
        mode: str | None = None,
        now: float = 0.0,
        unit: str = "mm",
    ) -> None:
        """Make the state of a window that has just opened.

        Args:
            viewable: The object to show.
            time: Initial time in seconds.
            values: The parameters that are not at their defaults, by name.
            view: The initial view.
            paused: Whether the time is paused at the start.
            guided: Whether the camera is kept out of solids, and keys show the whole scene; this
                compiles the scene's guide.
            mode: How light is computed: "direct" or "path"; None: as the scene says.
            now: The reading of the clock, in seconds.
            unit: The unit of length, which the ruler names.
        """
        self.clock = Clock(time, running=False, now=now)
        self.camera = GuidedCamera(viewable, is_guided=guided)
        self.mouse = Mouse()
        self.keys = Keys()
        self.buttons = 0
        self.values: dict[str, Value] = dict(values or {})
        self.view = view
        self.mode = mode
        self.plane = SectionPlane()
        self.ruler = RulerTool(viewable, unit)
        self.chosen = 0
        self.size = (640.0, 480.0)
        self.shows_parameters = self.shows_help = False
        self.shows_overlay = True
        self._begin = time
        self._wants_time = not paused
        self._grab: Grab | None = None
        self._at = self._pressed_at = (0.0, 0.0)
        self._clicks = False  # whether the pressed button clicks if the pointer stays
        self._last_time = interaction.last_time(time, time, None)
        self._moving_until = float("-inf")
        self.adopt(viewable, now)

    def adopt(self, viewable: Viewable, now: float, *, animated: bool | None = None) -> None:
        """Show another object with the same view, time, camera and parameters, if still valid.

        Args:
            viewable: The object to show.
            now: The reading of the clock, in seconds.
            animated: Whether its picture depends on the time; None computes it, which is slow.
        """
        self.viewable = viewable
        self.animated = viewable.animated if animated is None else animated
        self.dials: list[Dial] = dials(viewable.parameters)
        self.lines: list[Line] = lines_of(self.dials)
        self.values = valid_values(viewable.parameters, self.values)
        self.chosen = max(min(self.chosen, len(self.dials) - 1), 0)
        if self.view not in viewable.views:
            self.view = viewable.views[0]
        self.camera.adopt(viewable)
        self.ruler.adopt(viewable)
        # The object of the drag may no longer exist.
        self._grab = None
        self.clock.run(self._wants_time and self.animated, now)

    @property
    def playing(self) -> bool:
        """Whether the time runs."""
        return self.clock.running

    @property
    def time_range(self) -> tuple[float, float]:
        """The ends of the time bar, in seconds."""
        return interaction.first_time(self._begin, None), self._last_time

    def is_moving(self, now: float) -> bool:
        """Return whether a person is interacting; then fast frames are preferred to sharp ones."""
        return self._grab is not None or now < self._moving_until

    def settles_in(self, now: float) -> float:
        """Return the seconds until the picture no longer counts as moving."""
        return max(self._moving_until - now, 0.0)

    def shot(self, now: float) -> Shot:
        """Return the current shot."""
        self.camera.settle(self.moment(now))
        self.ruler.settle()
        time = self.clock.time(now)
        if self._grab is not Grab.TIME:
            self._last_time = interaction.last_time(time, self._begin, None)
        return Shot(
            time=time,
            parameters=tuple(sorted(self.values.items())),
            view=self.view,
            steering=self.steering if self.viewable.steers else None,
            mouse=self.mouse,
            mode=self.shown_mode,
            section=self.section(now),
            keys=self.keys,
            buttons=self.buttons if self.viewable.keeps_frames else 0,
        )

    def section(self, now: float) -> CutPlane | None:
        """Return the plane that cuts the scene open; None if it is whole or cannot be cut."""
        scene = self.viewable.scene
        if scene is None or self.plane.axis is None or not self.viewable.is_sectionable:
            return None
        return self.plane.section(scene, self.moment(now))

    @property
    def shown_mode(self) -> str:
        """How the light of the view is computed while nothing moves."""
        if self.viewable.scene is None or self.view != COLOR:
            return "direct"
        return self.viewable.mode if self.mode is None else self.mode

    def key_changed(self, code: int, *, down: bool) -> None:
        """Take a key that the picture reads."""
        self.keys = self.keys.with_key(code, down=down)

    def frame_begun(self) -> None:
        """Record that a frame has shown the press of the button, which is then no longer fresh."""
        if self.mouse.fresh:
            self.mouse = replace(self.mouse, fresh=False)

    def value(self, dial: Dial) -> Value:
        """Return the value of a control's parameter."""
        return self.values.get(dial.parameter.name, dial.parameter.default)

    @property
    def table(self) -> Table:
        """The layout of the table of parameters."""
        return Table.of(*self.size, len(self.lines), self.chosen_line)

    @property
    def chosen_line(self) -> int:
        """The index of the chosen control among the rows of the table."""
        return self.lines.index(self.dials[self.chosen]) if self.dials else 0

    # Keys

    def act(self, action: Action, now: float, *, shift: bool = False) -> None:
        """Perform the action of a key; actions of the window itself are ignored.

        Args:
            action: The action.
            now: The reading of the clock, in seconds.
            shift: Whether the shift key is held.
        """
        if action in SHOWN and self.viewable.steers:
            self.camera.show(action, self.moment(now))
        match action:
            case Action.PAUSE:
                self._pause(now)
            case Action.LEFT | Action.RIGHT | Action.UP | Action.DOWN:
                self._arrow(action, now, shift)
            case Action.NEARER | Action.FARTHER:
                self.wheel(1.0 if action is Action.FARTHER else -1.0, now)
            case Action.BACK | Action.FORTH:
                self._step(1 if action is Action.FORTH else -1, interaction.STEP_S, now)
            case Action.FRAME_BACK | Action.FRAME_FORTH:
                direction = 1 if action is Action.FRAME_FORTH else -1
                self._step(direction, 1.0 / interaction.FRAMES_PER_S, now)
            case Action.BEGIN:
                self._jump(self._begin, now)
            case Action.SLOWER | Action.FASTER:
                self.clock.change_speed(1 if action is Action.FASTER else -1, now)
            case Action.NEXT_VIEW | Action.LAST_VIEW:
                self._turn_views(1 if action is Action.NEXT_VIEW else -1)
            case Action.SECTION:
                self.plane = self.plane.turned()
            case Action.SECTION_SIDE:
                self.plane = self.plane.other_side()
            case Action.SECTION_BACK | Action.SECTION_FORTH:
                self.plane = self.plane.moved(1 if action is Action.SECTION_FORTH else -1)
                self._moving_until = now + _SETTLING_S
            case Action.RULER:
                self.ruler.toggle(self.sight(now))
            case Action.MODE:
                if self.viewable.scene is not None and self.view == COLOR:
                    self.mode = "direct" if self.shown_mode == "path" else "path"
            case Action.PARAMETERS:
                self.shows_parameters = not self.shows_parameters
            case Action.RESET_PARAMETER:
                self._reset_parameter(every=shift)
            case Action.RESET_CAMERA:
                self.camera.reset()
                self.mouse = Mouse()
            case Action.HELP:
                self.shows_help = not self.shows_help
            case Action.OVERLAY:
                self.shows_overlay = not self.shows_overlay
            case Action.SCREENSHOT | Action.COPY_CAMERA | Action.FULL_SCREEN | Action.QUIT:
                pass

    def refusal(self, action: Action) -> str:
        """Return why an action does nothing; "" if it does what its key says."""
        if action in _CUTS:
            reason = self.viewable.uncut_reason
            starts = action is Action.SECTION or self.plane.axis is not None
            return reason or ("" if starts else "press X first, which cuts the scene open")
        if action is Action.RULER and self.viewable.scene is None:
            return NEEDS_SOLID
        return ""

    def _pause(self, now: float) -> None:
        if self.animated:
            self._wants_time = not self.clock.running
            self.clock.run(self._wants_time, now)

    def _arrow(self, action: Action, now: float, shift: bool) -> None:
        """Perform an arrow key: it moves parameters while they are visible, as on a page."""
        right, up = _ARROWS[action]
        self._moving_until = now + _SETTLING_S
        if self.shows_parameters and self.shows_overlay and self.dials:
            if up:
                self.chosen = (self.chosen - up) % len(self.dials)
                return
            dial = self.dials[self.chosen]
            self._set(dial, dial.moved(self.value(dial), right, finely=shift))
            return
        way, rise = right * interaction.ARROW, up * interaction.ARROW
        if not self.viewable.steers:
            self.mouse = self.mouse.nudged(way, rise)
        # An arrow is the direction of the eye; a drag moves in the opposite direction.
        elif shift:
            self._go(panned(self.camera.aim, -way, rise), now)
        else:
            self._go(orbited(self.camera.aim, -way, rise, self.viewable.elevation), now)

    # The camera

    @property
    def steering(self) -> Steering:
        """The movement of the camera."""
        return self.camera.steering

    def moment(self, now: float) -> Moment:
        """Return what the camera's surroundings depend on."""
        return Moment(self.size, self.clock.time(now), dict(self.values))

    def sight(self, now: float) -> Sight:
        """Return how the scene is seen."""
        return Sight(self.moment(now), self.steering, self.section(now))

    def _go(self, goal: Steering, now: float) -> None:
        self.camera.go(goal, self.moment(now))

    def _step(self, direction: int, seconds: float, now: float) -> None:
        if self.animated:
            self._jump(self.clock.time(now) + direction * seconds, now)

    def _jump(self, time: float, now: float) -> None:
        self.clock.jump(interaction.jumped(time, self._begin, None), now)
        self._moving_until = now + _SETTLING_S

    def _turn_views(self, direction: int) -> None:
        views = self.viewable.views
        at = views.index(self.view) if self.view in views else 0
        self.view = views[(at + direction) % len(views)]

    def _reset_parameter(self, *, every: bool) -> None:
        if every:
            self.values.clear()
        elif self.dials and self.shows_parameters:
            self.values.pop(self.dials[self.chosen].parameter.name, None)

    def _set(self, dial: Dial, value: Value) -> None:
        parameter = dial.parameter
        checked = parameter.check(value)
        if checked == parameter.default:
            # Without a moved value, it follows the author's default when that is edited.
            self.values.pop(parameter.name, None)
        else:
            self.values[parameter.name] = checked

    # The pointer

    def press(self, x: float, y: float, button: int, now: float, *, shift: bool = False) -> None:
        """Start to drag what is under the pointer.

        Args:
            x: Position of the pointer, in units of the window from its left.
            y: Position of the pointer, from the top.
            button: The number of the button.
            now: The reading of the clock, in seconds.
            shift: Whether the shift key is held.
        """
        self._at = self._pressed_at = (x, y)
        self._grab = self._held(x, y, button, shift)
        self._clicks = self._grab is Grab.ORBIT
        if self._grab is Grab.MOUSE:
            place = self._place(x, y)
            self.mouse = Mouse(place, place, down=True, fresh=True)
        elif self._grab in (Grab.TIME, Grab.DIAL):
            if self._grab is Grab.TIME:
                self.clock.run(False, now)  # the time is paused while it is dragged
            self.drag(x, y, now)

    def is_free(self, x: float, y: float) -> bool:
        """Return whether a point is on the picture, not on the overlay."""
        if not self.shows_overlay:
            return True
        on_bar = self.animated and time_bar(*self.size).holds(x, y)
        return not on_bar and not (self.shows_parameters and self.table.frame.holds(x, y))

    def _held(self, x: float, y: float, button: int, shift: bool) -> Grab | None:
        if self.shows_overlay and button == _LEFT:
            if self.animated and time_bar(*self.size).holds(x, y):
                return Grab.TIME
            if self.shows_parameters and self.table.frame.holds(x, y):
                return self._held_in_table(x, y)
        if not self.viewable.steers:
            return Grab.MOUSE if button == _LEFT else None
        if button in (_RIGHT, _MIDDLE) or (button == _LEFT and shift):
            return Grab.PAN
        return Grab.ORBIT if button == _LEFT else None

    def _held_in_table(self, x: float, y: float) -> Grab | None:
        table = self.table
        row = table.row_at(x, y)
        if row is None:
            return None
        line = self.lines[row]
        if isinstance(line, str):
            return None
        self.chosen = self.dials.index(line)
        # If choosing the row scrolls it away from the pointer, its value is not moved.
        stays = self.table.first == table.first
        return Grab.DIAL if stays and table.track(row).holds(x, y) else None

    def drag(self, x: float, y: float, now: float) -> None:
        """Move what is being dragged.

        Args:
            x: Position of the pointer, in units of the window from its left.
            y: Position of the pointer, from the top.
            now: The reading of the clock, in seconds.
        """
        if math.dist(self._pressed_at, (x, y)) > _CLICK:
            self._clicks = False
        if self._clicks and self.ruler.is_on:
            return  # the camera stays while a place is clicked
        height = max(self.size[1], 1.0)
        right, down = (x - self._at[0]) / height, (y - self._at[1]) / height
        self._at = (x, y)
        match self._grab:
            case Grab.ORBIT:
                self._go(orbited(self.camera.aim, right, down, self.viewable.elevation), now)
            case Grab.PAN:
                self._go(panned(self.camera.aim, right, down), now)
            case Grab.MOUSE:
                self.mouse = replace(self.mouse, at=self._place(x, y))
            case Grab.TIME:
                low, high = self.time_range
                self._jump(low + time_track(*self.size).share(x) * (high - low), now)
            case Grab.DIAL:
                dial = self.dials[self.chosen]
                self._set(dial, dial.placed(self.value(dial), self.table.track(0).share(x)))
            case None:
                return
        self._moving_until = now + _SETTLING_S

    def release(self, now: float) -> None:
        """End the drag."""
        if self._grab is Grab.MOUSE:
            self.mouse = replace(self.mouse, down=False)
        if self._grab is Grab.TIME:
            self.clock.run(self._wants_time and self.animated, now)
        if self._clicks:
            self._clicks = False
            (x, y), (width, height) = self._pressed_at, self.size
            self.ruler.click(x / max(width, 1.0), y / max(height, 1.0), self.sight(now))
        self._grab = None

    def double_click(self, x: float, y: float, now: float) -> None:
        """Reset the camera to the author's; for an ``@image`` this does nothing.

        Args:
            x: Position of the pointer, in units of the window from its left.
            y: Position of the pointer, from the top.
            now: The reading of the clock, in seconds.
        """
        if self.viewable.steers and self.is_free(x, y) and not self.ruler.is_on:
            self.act(Action.RESET_CAMERA, now)

    def wheel(self, notches: float, now: float) -> None:
        """Zoom; positive notches move the eye away."""
        if self.viewable.steers:
            self._go(zoomed(self.camera.aim, notches), now)
            self._moving_until = now + _SETTLING_S

    def _place(self, x: float, y: float) -> tuple[float, float]:
        width, height = self.size
        return on_picture(x / max(width, 1.0), 1 - y / max(height, 1.0))
