"""Names of GLSL, HLSL, Shadertoy and Python's ``random``, and what scene code has instead.

Input: a name that is not defined. Output: a hint.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import distal.lang
from distal.frontend.problems import did_you_mean

_RANDOM: Final = "pcg(n) of distal.lang turns a whole number into a random one, the same each time"
# Of GLSL's habits, of Python's ``random`` and of ``numpy.random``.
_RANDOM_NAMES: Final = (
    *("random", "rand", "randint", "randn", "randrange", "uniform", "gauss", "normal", "choice"),
    *("integers", "standard_normal", "hash"),
)
# Neighboring pixels give other numbers on each driver, and none in branches of WGSL.
_DERIVATIVE: Final = "gradient(f, frame.coord) is exact; differences of pixels vary with the device"
_SAMPLE: Final = "sample(texture, p)"

_NOISE: Final = (
    *("value_noise", "gradient_noise", "simplex_noise", "fbm", "turbulence", "worley", "cellular"),
    "voronoi_border",
)
_CHANNEL: Final = "a Texture2D, or the name of a @buffer"

COUNTERPARTS: Final[Mapping[str, str]] = {
    **dict.fromkeys(_RANDOM_NAMES, _RANDOM),
    **{name: f"from distal.fields.noise import {name}" for name in _NOISE},
    **dict.fromkeys(
        ("noise", "snoise", "cnoise", "perlin", "perlin_noise"),
        "from distal.fields.noise import gradient_noise",
    ),
    "voronoi": "from distal.fields.noise import worley",
    **dict.fromkeys(("dFdx", "dFdy", "fwidth", "ddx", "ddy"), _DERIVATIVE),
    **dict.fromkeys(("texture", "texture2D", "tex2D", "texelFetch"), f"{_SAMPLE}, or texel"),
    "lerp": "mix(a, b, share)",
    "saturate": "clamp(x, 0.0, 1.0)",
    "fmod": "mod(a, b), or a % b",
    "frac": "fract(x)",
    "rsqrt": "inversesqrt(x)",
    "inverseSqrt": "inversesqrt(x)",
    "mul": "a @ b",
    "iTime": "frame.time, or time of distal",
    "iResolution": "frame.resolution of an @image",
    "iMouse": "frame.mouse of an @image",
    "iFrame": "frame.index of an @image",
    "iTimeDelta": "frame.delta of an @image",
    "iDate": "frame.date of an @image",
    **dict.fromkeys(("iChannel0", "iChannel1", "iChannel2", "iChannel3"), _CHANNEL),
    "fragCoord": "frame.coord of an @image, in pixels",
    "gl_FragCoord": "frame.coord of an @image, in pixels",
    "PI": "math.pi",
    "float2": "vec2",
    "float3": "vec3",
    "float4": "vec4",
    "float3x3": "mat3",
    "float4x4": "mat4",
}


def hint_for(name: str, known: set[str]) -> str | None:
    """Return what to write instead of a name that is not defined; None if nothing is similar.

    Args:
        name: The name.
        known: The names that are defined.
    """
    if name in dir(distal.lang) and not name.startswith("_"):
        return f"from distal.lang import {name}"
    return COUNTERPARTS.get(name) or did_you_mean(name, known)
