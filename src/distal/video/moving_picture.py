"""An animated picture: a picture as a function of time.

Input: a viewable object, a view, parameters. Output: pictures by index and time, and a fingerprint:
animated pictures with the same fingerprint have the same frames. Does not depend on files.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Final

from distal.devices.base import PartError
from distal.images.picture import Picture
from distal.ir.nodes import Origin
from distal.lang.chosen_values import checked_values
from distal.lang.live_textures import LiveTexture, SoundFile
from distal.lang.render_options import Refinement, RenderOptions
from distal.lang.runtime_access import cluster_kernels, executor
from distal.render import film
from distal.runtime.fingerprints import fingerprint
from distal.runtime.lowered import Lowered
from distal.scene.checks.warnings import (
    check_slopes,
    warn_of_camera,
    warn_of_functions,
    warn_of_light,
)
from distal.scene.view_options import refinement_of, steering_settings
from distal.scene.view_ranges import with_range
from distal.scene.viewing.viewable import COLOR, Viewable, viewable
from distal.sounds.reading import Samples, read
from distal.video.formats import VideoError
from distal.video.soundtrack import cut, mixed

if TYPE_CHECKING:
    from distal.lang.composed import Composed
    from distal.lang.functions import Image
    from distal.scene.scene import Scene

# Larger frames are rendered one at a time: each takes 16 bytes per pixel.
MOST_PIXELS_AT_ONCE: Final = 2**24


@dataclass(frozen=True, slots=True)
class MovingPicture:
    """A picture as a function of time.

    Attributes:
        name: The author's name of it.
        options: How to render each frame; time and index are those of the first frame.
        fingerprint: Equal for animated pictures with the same frames.
        source_hash: Hash of the text of the files that contain its scene code.
    """

    name: str
    options: RenderOptions
    fingerprint: str
    source_hash: str
    _image: Image | Composed = field(repr=False)
    _scene: Scene | None = field(repr=False)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        return self.options.size

    @property
    def parameters(self) -> Mapping[str, Any]:
        """The value of each parameter that it reads, by name."""
        return self.options.params

    @property
    def keeps_frames(self) -> bool:
        """Whether a frame is computed from those before it."""
        return bool(executor().parts(self._image).frames)

    def sound(self, start: Fraction, duration: Fraction) -> Samples | None:
        """Return what is heard with it: all sound files that it reads, mixed; None without one.

        Args:
            start: The time of its first frame, in seconds.
            duration: Seconds.

        Raises:
            LoadError: A file cannot be read.
        """
        sounds = executor().sounds(self._image)
        heard = [cut(read(each.path), start, duration, loop=each.loop) for each in sounds]
        return mixed(heard) if heard else None

    def picture(self, index: int, time: float, size: tuple[int, int] | None = None) -> Picture:
        """Render the picture at a time.

        Args:
            index: The index of the frame.
            time: Seconds.
            size: Width and height in pixels; None for the picture's own size.
        """
        [made] = self.pictures([(index, time)], size)
        if isinstance(made, PartError):
            raise made
        return made

    def pictures(
        self, moments: Sequence[tuple[int, float]], size: tuple[int, int] | None = None
    ) -> list[Picture | PartError]:
        """Render the pictures at some times, on a cluster by one worker.

        Args:
            moments: The index of each frame and its time in seconds.
            size: As for ``picture``.

        Returns:
            Each picture, or why it failed on a cluster.
        """
        size = size or self.size
        asked = [replace(self.options, size=size, time=t, index=i) for i, t in moments]
        if self.options.cluster is None:
            return [self._described(executor().render(self._image, each)) for each in asked]
        made = cluster_kernels.pictures(self.options.cluster, self._image, asked)
        return [each if isinstance(each, PartError) else self._described(each) for each in made]

    def _described(self, made: Picture) -> Picture:
        return made.with_provenance(
            view=self.options.view,
            stage=None if self._scene is None else self._scene.staged,
            steering=None if self.options.steering is None else self.options.steering.numbers,
        )

    @property
    def at_once(self) -> int:
        """How many frames are rendered at the same time.

        While one frame waits for its last part, or is converted to 8 bits, the next keeps
        processors busy. On two processors a video of 640x480 took 1.45 times as long as rendering
        alone, now 1.25.
        """
        if self.keeps_frames:  # each is computed from the one before it
            return 1
        if self.options.cluster is not None:
            return int(cluster_kernels.at_once(self.options.cluster))
        width, height = self.size
        return 3 if width * height <= MOST_PIXELS_AT_ONCE else 1

    def together(self, left: int) -> int:
        """Return how many of the frames that are left are best rendered one after the other.

        On a cluster more than one if they are quick: what a task costs is shared by them.
        """
        if self.options.cluster is None:
            return 1
        cluster = self.options.cluster
        return int(cluster_kernels.pictures_of_task(cluster, self._image, self.options, left))

    def warn_of_light(self, picture: Picture, time: float) -> None:
        """Warn of the first picture's light, as rendering a still picture does."""
        if self._scene is not None and self.options.view == COLOR:
            warn_of_light(self._scene, picture, self.parameters, time)


def moving_picture(obj: Any, options: RenderOptions) -> MovingPicture:
    """Return the animated picture of an object.

    Args:
        obj: A scene, a shape or an ``@image``.
        options: How to render each frame. The default scene of a single shape fits the size of
            the shape at this time and for these parameters.

    Raises:
        LoadError: The object is not a picture.
        VideoError: There is no such view, mode or parameter.
    """
    try:
        shown = viewable(obj, options.params, options.time).in_mode(options.mode)
    except ValueError as error:
        raise VideoError(str(error)) from None
    image, settings = _image(shown, options)
    refinement = _refinement(shown, options)
    lowered = Lowered.of(image, None)
    programs = (lowered, *executor().parts(image).frames)
    values = _values(shown, programs, options.params)
    # The range of the first frame's values, for all frames: it does not flicker.
    first = replace(options, params=values, settings=settings)
    settings = dict(with_range(image, first).settings)
    if shown.scene is not None:
        check_slopes(shown.scene.shape, values, options.time)
        warn_of_functions(shown.scene.shape, values, options.time)
        if refinement is None and options.view == COLOR:
            warn_of_camera(shown.scene)
    return MovingPicture(
        name=shown.name,
        options=replace(options, params=values, settings=settings, refinement=refinement),
        fingerprint=_fingerprint(programs, _asked(settings, options, refinement)),
        source_hash=lowered.source_hash,
        _image=image,
        _scene=shown.scene,
    )


def _image(shown: Viewable, options: RenderOptions) -> tuple[Image | Composed, Mapping[str, Any]]:
    """Return the program of the frames, and its settings.

    It computes display values where it can, because a second pass for each frame is slower.
    """
    try:
        if shown.scene is None:
            if options.steering is not None:
                raise VideoError(f"'{shown.name}' is an @image: it has no camera to move")
            return shown.image(options.view), {}
        image, settings = shown.scene.program(
            options.view,
            options.samples,
            encoded=True,
            mode=shown.mode,
            steered=options.steering is not None,
        )
        return image, {**settings, **steering_settings(options)}
    except ValueError as error:
        raise VideoError(str(error)) from None


def _refinement(shown: Viewable, options: RenderOptions) -> Refinement | None:
    """Return when a frame in mode "path" is finished; None in mode "direct"."""
    if shown.scene is None:
        if options.shutter is not None:
            raise VideoError("shutter is for scenes in mode 'path'")
        return None
    try:
        return refinement_of(replace(options, mode=None), shown.mode, shown.scene.shutter)
    except ValueError as error:
        raise VideoError(str(error)) from None


def _asked(
    settings: Mapping[str, Any], options: RenderOptions, refinement: Refinement | None
) -> dict[str, Any]:
    """Return the numbers of a frame that its program does not contain, for the fingerprint."""
    asked = {**settings, film.SAMPLES: options.samples}
    if refinement is not None and refinement.shutter > 0.0:
        asked["shutter"] = refinement.shutter
    return asked


def _values(
    shown: Viewable, programs: Sequence[Lowered], params: Mapping[str, Any]
) -> dict[str, Any]:
    """Return the parameters that the view reads; values for other parameters are allowed too."""
    read = {
        u.source.name: u.source
        for program in programs
        for u in program.module.uniforms
        if u.origin is Origin.PARAMETER and u.source is not None
    }
    try:
        chosen = checked_values(shown.parameters, params)
    except (ValueError, TypeError) as error:
        raise VideoError(str(error)) from None
    return {name: chosen.get(name, parameter.default) for name, parameter in read.items()}


def _fingerprint(programs: Sequence[Lowered], settings: Mapping[str, Any]) -> str:
    """Return the fingerprint of a picture's program and those of the images that it reads."""
    lowered, *others = programs
    numbers = {u.name: u.default for u in lowered.module.uniforms if u.origin is Origin.NUMBER}
    parts = [lowered.digest, numbers, dict(settings), *(program.digest for program in others)]
    resources = {
        f"{name}{number or ''}": source.path if isinstance(source, SoundFile) else source
        for number, program in enumerate(programs)
        for name, source in program.resources.items()
        if isinstance(source, SoundFile) or not isinstance(source, LiveTexture)
    }
    return fingerprint(parts, resources)
