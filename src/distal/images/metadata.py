"""Metadata: how a picture was rendered, as texts in its file.

Input: a ``Provenance``, or the texts of a file. Output: texts by key, or a ``Provenance``. Does not
depend on pixels or file formats.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Final, TypeAlias, TypeVar

from distal.diagnostics import LONGEST_MESSAGE, printable, readable
from distal.ir.limits import FRAME_SECONDS
from distal.lang.live_textures import NO_KEYS, Keys, checked_keys
from distal.version import __version__

_First = TypeVar("_First")
# The two ends of a ruler, in scene units.
Ends: TypeAlias = tuple[tuple[float, ...], tuple[float, ...]]

PREFIX: Final = "distal:"
# The text of ``Provenance.samples`` None.
ADAPTIVE: Final = "adaptive"
# Limits of a text's length and of the number of modules; distal never writes more.
_LONGEST_TEXT: Final = 2**20
_MOST_NEIGHBORS: Final = 10_000


class ReadError(Exception):
    """A picture file cannot be read or has no valid metadata; the message is one line."""

    def __init__(self, message: str) -> None:
        # The message may quote content of files from other sources.
        super().__init__(printable(message, LONGEST_MESSAGE))


@dataclass(frozen=True, slots=True, kw_only=True)
class Provenance:
    """How a picture was rendered: everything needed to render it again.

    Attributes:
        source: ``FILE[:NAME]`` or ``example:NAME`` as the author wrote it; without a file, the name
            of the scene or function; may be empty.
        source_hash: SHA-256 of the text of that file and of the modules in its folder that it
            imports; without a file, of the files of its functions; may be empty.
        neighbors: The paths of these modules relative to the folder of the file.
        parameters: The value of each parameter by name, as plain JSON values.
        time: Seconds.
        index: The number of the frame.
        seed: The seed of random numbers.
        mouse: The frame's mouse.
        buttons: The buttons of the mouse that were down.
        keys: The keyboard.
        delta: The seconds between two frames.
        date: The frame's date.
        live: Whether it reads earlier frames that a window drew, of which no file tells.
        samples: Samples in each pixel; None for one, and more where neighboring pixels differ.
        mode: How light was computed: "direct" or "path".
        paths: The options of mode "path" that were given, by name.
        view: The name of the view.
        plane: The plane of the view "slice": normal and offset.
        transparent: Whether alpha is 0 where a ray hits nothing.
        exposure: The given factor on all light; None if the scene's own was used.
        tone_map: The given tone map; None if the scene's own was used.
        steering: The movement of the camera: yaw, pitch, zoom, pan x and y; None if not moved.
        section: The plane that cut the scene open: normal, offset and distance of lines; None if it
            was whole.
        ruler: The ends of the ruler that is drawn over it; None if there is none.
        stage: The parameters and the time for which the default scene of a single shape was made;
            None for a scene.
        look: The given look; None if the scene's own was used.
        layers: The layers that were rendered with it.
        freeze: Whether the scene's numbers were compiled as constants.
        device: The device that rendered it.
    """

    source: str = ""
    source_hash: str = ""
    neighbors: tuple[str, ...] = ()
    parameters: Mapping[str, Any] = field(default_factory=dict)
    time: float = 0.0
    index: int = 0
    seed: int = 0
    mouse: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0)
    buttons: int = 0
    keys: Keys = NO_KEYS
    delta: float = FRAME_SECONDS
    date: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0)
    live: bool = False
    samples: int | None = 1
    mode: str = "direct"
    paths: Mapping[str, Any] = field(default_factory=dict)
    view: str = "color"
    plane: tuple[tuple[float, ...], float] | None = None
    transparent: bool = False
    exposure: float | None = None
    tone_map: str | None = None
    steering: tuple[float, ...] | None = None
    section: tuple[float, ...] | None = None
    ruler: Ends | None = None
    stage: tuple[Mapping[str, Any], float] | None = None
    look: str | None = None
    layers: tuple[str, ...] = ()
    freeze: bool = False
    device: str = ""


def texts(origin: Provenance, size: tuple[int, int]) -> dict[str, str]:
    """Return the texts for a picture's file; options with their default value are omitted."""
    found = {
        "Software": f"distal {__version__}",
        "distal:version": __version__,
        "distal:source": origin.source,
        "distal:source-hash": origin.source_hash,
        "distal:parameters": json.dumps(dict(origin.parameters), sort_keys=True),
        "distal:time": repr(float(origin.time)),
        "distal:size": f"{size[0]}x{size[1]}",
        "distal:index": str(origin.index),
        "distal:seed": str(origin.seed),
        "distal:mouse": json.dumps(list(origin.mouse)),
        "distal:samples": ADAPTIVE if origin.samples is None else str(origin.samples),
        "distal:view": origin.view,
        "distal:transparent": json.dumps(origin.transparent),
        "distal:device": origin.device,
    }
    found |= _frame_texts(origin)
    if origin.neighbors:
        found["distal:neighbors"] = json.dumps(origin.neighbors)
    if origin.mode != "direct":
        found["distal:mode"] = origin.mode
    if origin.paths:
        found["distal:paths"] = json.dumps(dict(origin.paths), sort_keys=True)
    if origin.plane is not None:
        found["distal:plane"] = json.dumps([list(origin.plane[0]), origin.plane[1]])
    if origin.exposure is not None:
        found["distal:exposure"] = repr(float(origin.exposure))
    if origin.tone_map is not None:
        found["distal:tone-map"] = origin.tone_map
    if origin.steering is not None:
        found["distal:steering"] = json.dumps(list(origin.steering))
    if origin.section is not None:
        found["distal:section"] = json.dumps(list(origin.section))
    if origin.ruler is not None:
        found["distal:ruler"] = json.dumps([list(end) for end in origin.ruler])
    if origin.stage is not None:
        values, time = origin.stage
        found["distal:stage"] = json.dumps([dict(values), float(time)], sort_keys=True)
    if origin.look is not None:
        found["distal:look"] = origin.look
    if origin.layers:
        found["distal:layers"] = ",".join(origin.layers)
    if origin.freeze:
        found["distal:freeze"] = "true"
    return {key: readable(text) for key, text in found.items()}


def _frame_texts(origin: Provenance) -> dict[str, str]:
    """Return the texts of what a picture reads of its frame, besides those that all files have."""
    found = {}
    if origin.buttons:
        found["distal:buttons"] = str(origin.buttons)
    if origin.keys != NO_KEYS:
        sets = (origin.keys.held, origin.keys.pressed, origin.keys.toggled)
        found["distal:keys"] = json.dumps([sorted(map(int, codes)) for codes in sets])
    if origin.delta != FRAME_SECONDS:
        found["distal:delta"] = repr(float(origin.delta))
    if any(origin.date):
        found["distal:date"] = json.dumps(list(origin.date))
    if origin.live:
        found["distal:live"] = "true"
    return found


def provenance(found: Mapping[str, str]) -> Provenance:
    """Return the provenance described by texts; missing entries have their defaults.

    Raises:
        ReadError: A text is invalid.
    """

    def json_of(key: str, otherwise: Any) -> Any:
        return json.loads(found[key]) if key in found else otherwise

    try:
        if any(len(text) > _LONGEST_TEXT for text in found.values()):
            raise ValueError("a text is too long")
        plane = json_of("distal:plane", None)
        steering = json_of("distal:steering", None)
        section = json_of("distal:section", None)
        ruler = json_of("distal:ruler", None)
        stage = json_of("distal:stage", None)
        exposure = found.get("distal:exposure")
        samples = found.get("distal:samples", "1")
        return Provenance(
            source=found.get("distal:source", ""),
            source_hash=found.get("distal:source-hash", ""),
            neighbors=_places(json_of("distal:neighbors", [])),
            parameters=_values(json_of("distal:parameters", {})),
            time=_number(float(found.get("distal:time", "0"))),
            index=int(found.get("distal:index", "0")),
            seed=int(found.get("distal:seed", "0")),
            mouse=_numbers(json_of("distal:mouse", [0.0] * 4), 4),
            buttons=int(found.get("distal:buttons", "0")),
            keys=_keys(json_of("distal:keys", [[], [], []])),
            delta=_number(float(found.get("distal:delta", FRAME_SECONDS))),
            date=_numbers(json_of("distal:date", [0.0] * 4), 4),
            live=_flag(found.get("distal:live", "false")),
            samples=None if samples == ADAPTIVE else int(samples),
            mode=found.get("distal:mode", "direct"),
            paths=_values(json_of("distal:paths", {})),
            view=found.get("distal:view", "color"),
            plane=None if plane is None else _pair(plane, lambda normal: _numbers(normal, 3)),
            transparent=_flag(found.get("distal:transparent", "false")),
            exposure=None if exposure is None else _number(float(exposure)),
            tone_map=found.get("distal:tone-map"),
            steering=None if steering is None else _numbers(steering, 5),
            section=None if section is None else _numbers(section, 5),
            ruler=None if ruler is None else _ends(ruler),
            stage=None if stage is None else _pair(stage, _values),
            look=found.get("distal:look"),
            layers=tuple(filter(None, found.get("distal:layers", "").split(","))),
            freeze=_flag(found.get("distal:freeze", "false")),
            device=found.get("distal:device", ""),
        )
    except (ValueError, TypeError, LookupError, RecursionError, OverflowError):
        raise ReadError("what it says about itself is garbled") from None


def _number(given: Any) -> float:
    if isinstance(given, bool) or not isinstance(given, int | float):
        raise TypeError("a number is wanted")
    value = float(given)
    if not math.isfinite(value):
        raise ValueError("a finite number is wanted")
    return value


def _numbers(given: Any, count: int) -> tuple[float, ...]:
    if not isinstance(given, list) or len(given) != count:
        raise ValueError(f"{count} numbers are wanted")
    return tuple(map(_number, given))


def _keys(given: Any) -> Keys:
    if not isinstance(given, list) or len(given) != 3:
        raise ValueError("three sets of keys are wanted")
    return Keys(*(frozenset(checked_keys(codes).held) for codes in given))


def _ends(given: Any) -> Ends:
    if not isinstance(given, list) or len(given) != 2:
        raise ValueError("two ends are wanted")
    return _numbers(given[0], 3), _numbers(given[1], 3)


def _pair(given: Any, first: Callable[[Any], _First]) -> tuple[_First, float]:
    if not isinstance(given, list) or len(given) != 2:
        raise ValueError("a pair is wanted")
    return first(given[0]), _number(given[1])


def _flag(text: str) -> bool:
    if text not in ("true", "false"):
        raise ValueError("true or false is wanted")
    return text == "true"


def _values(given: Any) -> dict[str, Any]:
    """Return values of parameters, checked: numbers, words, or lists of numbers."""
    if not isinstance(given, dict):
        raise TypeError("values by name are wanted")
    for value in given.values():
        parts = value if isinstance(value, list) else [value]
        if not all(isinstance(part, str | int | float) for part in parts):
            raise TypeError("a parameter's value is a number, a word or a list")
    return given


def _places(given: Any) -> tuple[str, ...]:
    if not isinstance(given, list) or not all(isinstance(place, str) for place in given):
        raise TypeError("a list of files is wanted")
    if len(given) > _MOST_NEIGHBORS or len(set(given)) != len(given):
        raise ValueError("each file is named once")
    return tuple(given)
