"""The ruler of a window: clicks become places on the surface, two of them a ruler.

Input: clicks, the movement of the camera, the moment in which they happen. Output: the ends, and
where they are seen. Compiles in a thread of its own; a click waits for it. Does not depend on
displays.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from distal.diagnostics import CompileError, DeviceError
from distal.scene.section import CutPlane
from distal.scene.steering import Steering
from distal.scene.viewing.guide import Moment
from distal.scene.viewing.ruler import RulerEnd, SeenRuler, end_text, measures_text

if TYPE_CHECKING:
    from distal.scene.viewing.viewable import Viewable

NEEDS_SOLID: Final = "a ruler is for scenes and shapes; an @image has no surface"
_FIRST: Final = "ruler: click the first place"
_PREPARING: Final = "preparing the ruler …"
_NOTHING: Final = "nothing is there; click a place on the shape"


@dataclass(frozen=True, slots=True)
class Sight:
    """How the scene is seen: what a place under the pointer depends on.

    Attributes:
        moment: Size of the picture, time and parameters.
        steering: The movement of the camera.
        section: The plane of a scene that is cut open; None if it is whole.
    """

    moment: Moment
    steering: Steering
    section: CutPlane | None


@dataclass(frozen=True, slots=True)
class ShownRuler:
    """A ruler as it is drawn.

    Attributes:
        kinds: What its one or two ends are on.
        places: Fractions of the picture's width and height from its upper left; None: not seen.
        lines: The lines of its label; none while it has one end.
    """

    kinds: tuple[str, ...]
    places: tuple[tuple[float, float] | None, ...]
    lines: tuple[str, ...]


class RulerTool:
    """The ruler of a window.

    Attributes:
        is_on: Whether clicks choose places.
        ends: The places that were chosen: none, one or two.
        unit: The unit of length, such as "mm".
    """

    def __init__(self, viewable: Viewable, unit: str = "mm") -> None:
        self.is_on = False
        self.ends: tuple[RulerEnd, ...] = ()
        self.unit = unit
        self._viewable = viewable
        self._then: Callable[[], None] | None = None
        self._thread: threading.Thread | None = None
        self._click: tuple[float, float, Sight] | None = None
        self._message = ""
        self._shown: tuple[tuple[RulerEnd, ...], Moment, Steering, SeenRuler] | None = None

    def compile_aside(self, then: Callable[[], None]) -> None:
        """Compile in a thread from now on; ``then`` is called in it when that is done."""
        self._then = then

    def adopt(self, viewable: Viewable) -> None:
        """Continue with another object, whose places are the same if it has a surface."""
        self._viewable, self._click, self._shown = viewable, None, None
        if viewable.scene is None:
            self.remove()

    def toggle(self, sight: Sight) -> None:
        """Start to choose places, or remove the ruler."""
        if self.is_on:
            self.remove()
        elif self._viewable.scene is not None:
            self.is_on = True
            self._is_ready(sight)

    def remove(self) -> None:
        """Remove the ruler."""
        self.is_on, self.ends, self._click, self._message = False, (), None, ""

    def click(self, x: float, y: float, sight: Sight) -> None:
        """Choose the place on the surface at a place in the picture; a third one starts anew.

        Args:
            x: Fraction of the picture's width, from its left.
            y: Fraction of the picture's height, from its top.
            sight: How the scene is seen.
        """
        if self.is_on:
            self._click = (x, y, sight)
            self.settle()

    def settle(self) -> None:
        """Do what a click has asked for, unless the programs are still being compiled."""
        if self._click is None or not self._is_ready(self._click[2]):
            return
        (x, y, sight), self._click = self._click, None
        finder = self._viewable.shown_with(sight.section).ruler
        assert finder is not None
        end = finder.place_at(x, y, sight.moment, sight.steering, sight.section)
        self._message = "" if end is not None else _NOTHING
        if end is not None:
            self.ends = (end,) if len(self.ends) == 2 else (*self.ends, end)

    @property
    def hint(self) -> str:
        """What to do next; "" if there is a ruler or none is wanted."""
        if not self.is_on:
            return self._message  # why it was removed
        if self._click is not None:
            return _PREPARING
        if self._message:
            return self._message
        if not self.ends:
            return _FIRST
        return f"from {end_text(self.ends[0])}: click the second place" if self.is_open else ""

    @property
    def is_open(self) -> bool:
        """Whether the second place is still to be chosen."""
        return len(self.ends) == 1

    def shown(self, sight: Sight) -> ShownRuler | None:
        """Return the ruler as it is drawn; None if there is none, or it is still compiled."""
        if not self.ends or not self._is_ready(sight):
            return None
        start, end = self.ends[0], self.ends[-1]
        moment, steering, known = sight.moment, sight.steering, self._shown
        if known is None or known[:3] != (self.ends, moment, steering):
            ruler = self._viewable.ruler
            assert ruler is not None
            found = ruler.seen(start, end, moment, steering)
            known = self._shown = (self.ends, moment, steering, found)
        seen, kinds = known[3], tuple(e.kind for e in self.ends)
        if self.is_open:
            return ShownRuler(kinds, seen.places[:1], ())
        return ShownRuler(kinds, seen.places, measures_text(start, end, seen, self.unit))

    @property
    def is_preparing(self) -> bool:
        """Whether its programs are being compiled."""
        return self._thread is not None and self._thread.is_alive()

    def _is_ready(self, sight: Sight) -> bool:
        """Return whether places can be found; if not, start to compile what it takes."""
        whole, shown = self._viewable.ruler, self._viewable.shown_with(sight.section).ruler
        assert whole is not None
        assert shown is not None
        if self._then is None or (whole.shows and shown.finds):
            return True
        if self.is_preparing:
            return False
        then = self._then

        def work() -> None:
            try:
                whole.prepare_seen(sight.moment)
                shown.prepare_places(sight.moment, sight.section)
            except (CompileError, DeviceError) as error:
                self.remove()
                self._message = str(error).splitlines()[0]
            then()

        # A daemon, because a compiler cannot be interrupted.
        self._thread = threading.Thread(target=work, name="distal-ruler", daemon=True)
        self._thread.start()
        return False
