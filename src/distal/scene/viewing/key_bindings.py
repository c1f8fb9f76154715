"""Keys and their actions in windows, pages and notebooks, with the text of the help.

Input: nothing. Output: tables; ``tools/gen_player.py`` copies those of pages to TypeScript. Has no
behaviour.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True, slots=True)
class Binding:
    """The keys of an action.

    Attributes:
        action: The name of the action.
        keys: Typed characters, or names of keys as in browsers. A small letter includes the
            capital, unless the capital has an action.
        in_page: Whether pages and notebooks have the action; those of windows only do not.
        window_keys: Further keys in windows, which a browser uses itself.
        in_path_page: Whether only pages of scenes in mode "path" have it; ``in_page`` is True.
        in_inspect_page: Whether pages to inspect have it too; ``in_page`` is False.
        opposite: The action of the same keys with shift or ctrl, if they are digits: what they
            type with shift depends on the keyboard.
    """

    action: str
    keys: tuple[str, ...] = ()
    in_page: bool = True
    window_keys: tuple[str, ...] = ()
    opposite: str | None = None
    in_path_page: bool = False
    in_inspect_page: bool = False


BINDINGS: Final = (
    Binding("left", ("ArrowLeft",)),
    Binding("right", ("ArrowRight",)),
    Binding("up", ("ArrowUp",)),
    Binding("down", ("ArrowDown",)),
    # Plus and underscore need shift on many keyboards; accept the keys with and without it.
    Binding("nearer", ("+", "=")),
    Binding("farther", ("-", "_")),
    Binding("reset_camera", ("r",)),
    Binding("frame", ("f",)),
    Binding("front", ("1",), opposite="back_side"),
    Binding("right_side", ("3",), opposite="left_side"),
    Binding("top", ("7",), opposite="bottom"),
    Binding("copy_camera", ("c",)),
    Binding("pause", (" ",)),
    Binding("back", (",",)),
    Binding("forth", (".",)),
    # These keys with shift, on American and on European keyboards.
    Binding("frame_back", ("<", ";")),
    Binding("frame_forth", (">", ":")),
    Binding("begin", ("Home",)),
    Binding("slower", ("[",)),
    Binding("faster", ("]",)),
    Binding("next_view", ("v",)),
    Binding("last_view", ("V",)),
    Binding("section", ("x",), in_page=False, in_inspect_page=True),
    Binding("section_side", ("X",), in_page=False, in_inspect_page=True),
    Binding("section_back", window_keys=("PageDown",), in_page=False),
    Binding("section_forth", window_keys=("PageUp",), in_page=False),
    Binding("ruler", ("d",), in_page=False, in_inspect_page=True),
    Binding("mode", ("m",), in_path_page=True),
    Binding("parameters", ("p",), window_keys=("Tab",)),
    Binding("screenshot", ("s",)),
    Binding("full_screen", ("F",), window_keys=("F11",)),
    Binding("help", ("h", "?")),
    Binding("overlay", ("o",), in_page=False),
    Binding("reset_parameter", ("Backspace",), in_page=False),
    Binding("quit", ("q", "Escape"), in_page=False),
)


@dataclass(frozen=True, slots=True)
class Help:
    """A line of the help.

    Attributes:
        keys: The keys or the gesture.
        meaning: Their effect.
        needs: What must exist for the line to be shown: "camera", "mouse" (a picture that reads
            it), or an action of ``BINDINGS``.
        in_page: Whether pages show the line.
    """

    keys: str
    meaning: str
    needs: str
    in_page: bool = True


HELP: Final = (
    Help("Drag, arrows", "Turn around the scene", "camera"),
    Help("Right or shift drag", "Move the scene (shift arrows, two fingers)", "camera"),
    Help("Wheel, pinch, + -", "Nearer, farther", "camera"),
    Help("R, double click", "Reset the camera", "camera"),
    Help("F", "See the whole scene", "camera"),
    Help("1  3  7", "From the front, right, top (shift: opposite)", "camera"),
    Help("C", "Copy the camera as Python", "camera"),
    Help("Drag, arrows", "The mouse that the picture reads", "mouse"),
    Help("R", "Reset the mouse", "mouse"),
    Help("Space", "Play or pause", "pause"),
    Help(",  .", "Step in time (shift: one frame)", "back"),
    Help("Home", "Back to the start time", "begin"),
    Help("[  ]", "Slower, faster", "slower"),
    Help("V, shift V", "Next view, the one before", "next_view"),
    Help("X, shift X", "Cut open along x, y, z; the other side", "section", False),
    Help("Page up, down", "Move the cut", "section_forth", False),
    Help("D, then clicks", "Measure a distance (D, Esc: remove)", "ruler", False),
    Help("M", "Direct light or paths", "mode"),
    Help("P", "Parameters", "parameters"),
    Help("P, then arrows", "Choose and change one (shift: finely)", "parameters", False),
    Help("Backspace", "Reset a parameter (shift: all)", "reset_parameter", False),
    Help("S", "Save a picture", "screenshot"),
    Help("Shift F", "Full screen", "full_screen"),
    Help("O", "Hide all this", "overlay", False),
    Help("H, ?", "This list", "help"),
    Help("Q, Esc", "Close", "quit", False),
)
