"""What files hold of a surface's appearance, as scene code.

Input: a ``Surface``. Output: a color, and the numbers of a glTF material. Does not depend on
meshes.
"""

from __future__ import annotations

from distal.lang import clamp, func, max, mix, vec3, vec4
from distal.render.material import Surface


@func
def shown_color(surface: Surface) -> vec3:
    """Return a color that files can hold: each part from 0 to 1."""
    return clamp(surface.color, 0.0, 1.0)


@func
def gltf_numbers(surface: Surface) -> vec4:
    """Return metallic, roughness, transmission and index of refraction, as glTF has them.

    A dielectric of glTF mirrors 4 percent of the light at its center. A surface that mirrors less
    has no highlight here, and gets a roughness between its own and 1.

    Source: glTF 2.0 Specification, appendix B; KHR_materials_transmission.
    """
    total = max(surface.diffuse + surface.specular + surface.transmission, 1e-6)
    mirrors = clamp((surface.specular + surface.fresnel) / 0.04, 0.0, 1.0)
    roughness = mix(1.0, clamp(surface.roughness, 0.0, 1.0), mirrors)
    metallic = clamp(surface.metal * surface.specular / total, 0.0, 1.0)
    transmission = clamp(surface.transmission / total, 0.0, 1.0)
    return vec4(metallic, roughness, transmission, max(surface.ior, 1.0))


@func
def appearance(surface: Surface) -> tuple[vec3, vec4, vec3]:
    """Return the color, ``gltf_numbers``, and the emitted light, each part from 0 to 1."""
    return shown_color(surface), gltf_numbers(surface), clamp(surface.emission, 0.0, 1.0)
