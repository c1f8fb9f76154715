"""The looks of the library: their numbers, and the functions by which authors change them.

Input: the author's numbers, by name. Output: a ``Look``. Every number of every look stands in this
module. Angles of lights are relative to the camera, so a picture is lit alike from every side.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from typing import Any, Final

from distal.diagnostics import Span
from distal.frontend.problems import did_you_mean
from distal.lang.source_places import author_place
from distal.render.backdrops import open_air, paper, studio_backdrop
from distal.scene.looks.look import COLORS, Look, LookRow, look_numbers
from distal.scene.objects.declared import annotation_of
from distal.scene.tree.arguments import slots_of, takes_color
from distal.scene.tree.errors import refuse, refuse_kind

CLAY: Final = (0.78, 0.70, 0.61)

NO_RIM: Final = {
    "rim_azimuth": 0.0,
    "rim_elevation": 0.0,
    "rim_intensity": 0.0,
    "rim_color": (1.0, 1.0, 1.0),
}

ROWS: Final[dict[str, LookRow]] = {
    "studio": LookRow(
        doc="A photographer's studio: a seamless floor, a large soft lamp, a rim light.",
        backdrop=studio_backdrop,
        main="lamp",
        tone_map="aces",
        numbers={
            "azimuth": 0.5,
            "elevation": 0.27,
            "fov_deg": 28.0,
            "margin": 1.3,
            "exposure": 1.0,
            "light_azimuth": -1.01,
            "light_elevation": 0.80,
            "light_intensity": 1.9,
            "light_color": (1.0, 0.955, 0.89),
            "light_angle": 0.26,
            "rim_azimuth": 2.44,
            "rim_elevation": 0.66,
            "rim_intensity": 0.7,
            "rim_color": (0.80, 0.90, 1.0),
            "fill": 0.36,
            "sky": (0.92, 0.96, 1.03),
            "ground": (0.62, 0.56, 0.50),
            "zenith": (0.30, 0.30, 0.32),
            "horizon": (1.0, 1.0, 1.0),
            "floor_color": (0.40, 0.39, 0.38),
            "material": (0.74, 0.61, 0.49),
            "haze": 0.0,
        },
    ),
    "outdoor": LookRow(
        doc="Daylight: a clear sky, a sun with firm shadows, haze at the horizon.",
        backdrop=open_air,
        air={"glow": (0.9, 0.82, 0.66), "disc": (6.0, 5.6, 5.0), "band": 0.10, "starlight": 0.0},
        numbers={
            "azimuth": 0.5,
            "elevation": 0.13,
            "fov_deg": 32.0,
            "margin": 1.42,
            "exposure": 0.92,
            "light_azimuth": -1.08,
            "light_elevation": 0.66,
            "light_intensity": 2.3,
            "light_color": (1.0, 0.87, 0.68),
            "light_angle": 0.035,
            **NO_RIM,
            "fill": 0.54,
            "sky": (0.42, 0.62, 1.0),
            "ground": (0.40, 0.36, 0.30),
            "zenith": (0.04, 0.17, 0.55),
            "horizon": (0.62, 0.76, 0.88),
            "floor_color": (0.30, 0.258, 0.19),
            "material": (0.70, 0.57, 0.44),
            "haze": 0.012,
        },
    ),
    "sunset": LookRow(
        doc="The last sun: warm light from behind, long shadows, a blue sky overhead.",
        backdrop=open_air,
        air={"glow": (1.4, 0.50, 0.12), "disc": (9.0, 5.0, 2.4), "band": 0.15, "starlight": 0.0},
        numbers={
            "azimuth": 0.5,
            "elevation": 0.09,
            "fov_deg": 32.0,
            "margin": 1.5,
            "exposure": 1.05,
            "light_azimuth": -1.74,
            "light_elevation": 0.2,
            "light_intensity": 2.8,
            "light_color": (1.0, 0.52, 0.22),
            "light_angle": 0.05,
            **NO_RIM,
            "fill": 0.44,
            "sky": (0.34, 0.48, 0.98),
            "ground": (0.40, 0.26, 0.24),
            "zenith": (0.03, 0.11, 0.36),
            "horizon": (0.98, 0.46, 0.25),
            "floor_color": (0.15, 0.16, 0.21),
            "material": (0.76, 0.64, 0.54),
            "haze": 0.008,
        },
    ),
    "night": LookRow(
        doc="Moonlight under stars, and one warm lamp.",
        backdrop=open_air,
        second="lamp",
        distance=5.0,
        air={"glow": (0.05, 0.07, 0.11), "disc": (2.0, 2.2, 2.4), "band": 0.12, "starlight": 1.6},
        numbers={
            "azimuth": 0.5,
            "elevation": 0.12,
            "fov_deg": 30.0,
            "margin": 1.4,
            "exposure": 1.7,
            "light_azimuth": -1.22,
            "light_elevation": 0.77,
            "light_intensity": 0.6,
            "light_color": (0.55, 0.72, 1.0),
            "light_angle": 0.04,
            "rim_azimuth": 2.06,
            "rim_elevation": 0.42,
            "rim_intensity": 2.6,
            "rim_color": (1.0, 0.50, 0.18),
            "fill": 0.36,
            "sky": (0.10, 0.16, 0.34),
            "ground": (0.05, 0.05, 0.07),
            "zenith": (0.002, 0.005, 0.018),
            "horizon": (0.020, 0.042, 0.090),
            "floor_color": (0.13, 0.14, 0.17),
            "material": (0.74, 0.64, 0.54),
            "haze": 0.012,
        },
    ),
    "blueprint": LookRow(
        doc="A technical drawing: pale lines in round steps of the scene's unit on blue paper.",
        backdrop=paper,
        tone_map="none",
        lined=True,
        numbers={
            "azimuth": 0.5,
            "elevation": 0.5,
            "fov_deg": 14.0,
            "margin": 1.25,
            "exposure": 1.0,
            "light_azimuth": -0.87,
            "light_elevation": 0.87,
            "light_intensity": 0.75,
            "light_color": (1.0, 1.0, 1.0),
            "light_angle": 0.15,
            **NO_RIM,
            "fill": 0.62,
            "sky": (0.90, 0.95, 1.0),
            "ground": (0.45, 0.50, 0.60),
            "zenith": (0.020, 0.085, 0.26),
            "horizon": (0.020, 0.085, 0.26),
            "floor_color": (0.020, 0.085, 0.26),
            "material": (0.10, 0.26, 0.58),
            "haze": 0.0,
        },
    ),
}
NAMES: Final = tuple(ROWS)
DEFAULT: Final = "studio"


def as_look(value: Any, place: Span | None) -> Look:
    """Return the look of a name; None is the default look.

    Raises:
        SceneValueError: There is no such look.
        SceneTypeError: The value is neither a look nor a name.
    """
    if isinstance(value, Look):
        return value
    name = DEFAULT if value is None else value
    if not isinstance(name, str):
        called = getattr(value, "__name__", None)
        hint = f"{called}()" if called in ROWS else f'look="{DEFAULT}"'
        refuse_kind(f"a look is wanted, not {value!r:.60}", hint, place)
    if name not in ROWS:
        hint = did_you_mean(name, NAMES) or f"looks: {', '.join(NAMES)}"
        refuse(f"there is no look {name!r:.40}", hint, place)
    return Look(name, ROWS[name], {}, place)


def _function(name: str, row: LookRow) -> Callable[..., Look]:
    """Return the public function of a look."""

    def made(**numbers: Any) -> Look:
        return Look(name, row, numbers, author_place())

    by_name = inspect.Parameter.KEYWORD_ONLY
    parameters = [
        inspect.Parameter(
            slot.name,
            by_name,
            default=row.numbers[slot.name],
            annotation=annotation_of(slot.type, is_color=takes_color(slot.name, COLORS)),
        )
        for slot in slots_of(look_numbers)
    ]
    made.__name__ = made.__qualname__ = name
    made.__module__ = __name__
    made.__doc__ = _documentation(row)
    made.__dict__["__signature__"] = inspect.Signature(parameters, return_annotation="Look")
    return made


def _documentation(row: LookRow) -> str:
    listed = re.sub(r"^.*?Args:", "Args:", inspect.getdoc(look_numbers) or "", flags=re.DOTALL)
    raises = (
        "Raises:\n    ValueError: A number is out of its range.\n"
        "    TypeError: An argument is of another kind."
    )
    return f"{row.doc}\n\n{listed}\n\n{raises}\n"


FUNCTIONS: Final = {name: _function(name, row) for name, row in ROWS.items()}
globals().update(FUNCTIONS)
