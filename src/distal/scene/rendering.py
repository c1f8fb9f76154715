"""Rendering of a scene: runs its programs and gives warnings.

Input: a scene and the options of a picture. Output: a ``Picture`` with its layers and a
record of how it was made. Needs NumPy; scenes compile without this module.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, Final

from distal.images.denoising import check_denoiser, denoised
from distal.lang.render_options import Progress, Refinement, RenderOptions
from distal.lang.runtime_access import executor
from distal.scene.checks.warnings import (
    check_slopes,
    hidden_camera,
    shows,
    warn_of_camera,
    warn_of_darkness,
    warn_of_functions,
    warn_of_light,
    warn_of_lost_rays,
)
from distal.scene.lowering.layers import OF_SAMPLES, values
from distal.scene.lowering.picture import PATH_LAYERS
from distal.scene.tree.errors import refuse
from distal.scene.view_options import (
    path_settings,
    recorded,
    refinement_of,
    slice_settings,
    steering_settings,
)
from distal.scene.view_ranges import with_range

if TYPE_CHECKING:
    from distal.images.picture import Picture
    from distal.scene.scene import Scene

# Samples of a mean albedo or normal: their noise is small.
LAYER_SAMPLES: Final = 64


def render_scene(scene: Scene, options: RenderOptions) -> Picture:
    """Render a scene and its layers.

    Args:
        scene: The scene.
        options: What is shown of it, and how it is rendered.

    Raises:
        CompileError: The scene has mistakes, or its camera is inside a solid.
        DeviceError: The device is missing or was lost.
    """
    sliced, moved = slice_settings(options), steering_settings(options)
    check_slopes(scene.shape, options.params, options.time)
    warn_of_functions(scene.shape, options.params, options.time)
    warn_of_darkness(scene)
    refinement = refinement_of(options, scene.mode, scene.shutter)
    computed = [name for name in options.layers if name not in OF_SAMPLES]
    shares = _shares(options.progress, 1 + len(computed))
    image, sampled = scene.program(
        options.view,
        options.samples,
        mode=options.mode,
        filter=options.filter,
        caustics=options.caustics,
        transparent=options.transparent,
        steered=options.steering is not None,
    )
    settings = {**sampled, **sliced, **moved}
    if refinement is None and options.view == "color":
        warn_of_camera(scene)
    else:
        settings |= path_settings(options)
    if refinement is not None and options.denoise:
        check_denoiser()
        guided = replace(options, settings=moved, progress=None, refinement=refinement)
        refinement = replace(refinement, finish=partial(_denoised, scene, guided))
    asked = replace(options, settings=settings, progress=shares[0], refinement=refinement)
    asked = with_range(image, asked)
    picture = executor().render(image, asked)
    if options.view == "color":
        _check_visible(scene, picture, options)
        warn_of_lost_rays(scene, picture.stats["lost"])
    of_samples = {name: picture.layers[name] for name in options.layers if name in OF_SAMPLES}
    layers = {
        name: _layer(scene, name, replace(asked, settings=moved, progress=share))
        for name, share in zip(computed, shares[1:], strict=True)
    } | of_samples
    if refinement is not None and options.clamp is not None:
        picture = replace(picture, stats={**picture.stats, "clamp": options.clamp})
    return picture.with_layers(layers).with_provenance(
        view=options.view,
        mode="direct" if refinement is None else "path",
        paths={} if refinement is None else recorded(options),
        transparent=options.transparent,
        plane=tuple(sliced.values()) or None,
        section=None if options.section is None else options.section.numbers,
        steering=None if options.steering is None else options.steering.numbers,
        stage=scene.staged,
        layers=options.layers,
        **scene.asked_display,
    )


def _check_visible(scene: Scene, picture: Picture, options: RenderOptions) -> None:
    """Refuse a picture taken from inside a solid; warn of a black picture."""
    if not options.transparent and not shows(picture.array[..., 3]):
        where, hint = hidden_camera(scene)
        refuse(f"the camera is {where}, and no ray finds a way out", hint, scene.place)
    warn_of_light(scene, picture, options.params, options.time)


def _denoised(scene: Scene, options: RenderOptions, light: Any) -> Any:
    """Return linear light without noise, guided by layers of the same samples."""
    albedo, normal = (_layer(scene, name, options) for name in ("albedo", "normal"))
    return denoised(light, albedo, normal)


def _layer(scene: Scene, name: str, options: RenderOptions) -> Any:
    """Return the values of a layer."""
    steered, refinement = options.steering is not None, options.refinement
    if refinement is None or name not in PATH_LAYERS:
        layer = scene.layer(name, steered=steered)
    else:
        layer = scene.path_layer(name, options.filter, steered=steered)
        count = min(refinement.samples, LAYER_SAMPLES)
        alike = Refinement(samples=count, shutter=refinement.shutter, signed=refinement.signed)
        found = executor().render(layer, replace(options, refinement=alike)).linear
        return found[..., :3] * found[..., 3:]
    return values(name, executor().render(layer, options).array)


def _shares(progress: Progress | None, count: int) -> list[Progress | None]:
    """Return one progress callback for each of several equally long parts of the work."""
    if progress is None:
        return [None] * count
    whole = progress

    def part(done: int) -> Progress:
        return lambda share: whole((done + share) / count)

    return [part(done) for done in range(count)]
