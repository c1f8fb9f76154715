"""Scenes as the app shows them: the answer of ``look`` and ``hold``.

Input: the texts of a scene's files. Output: the payload of one view, or only its numbers where the
program stayed. Needs the standard library alone.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path, PurePath
from typing import Any, Final, Literal, cast

from distal.diagnostics import CompileError, Diagnostic, Label, LoadError, Span
from distal.editor.edits import applied
from distal.editor.literals import find_literals, literal_at
from distal.editor.messages import (
    Edit,
    HoldRequest,
    LookRequest,
    Mistake,
    MistakeLabel,
    NumbersFound,
    Printed,
    Progress,
    SceneFound,
    ShapePlace,
    SourceLiteral,
    SourceRequest,
)
from distal.editor.places import shapes_of
from distal.editor.programs import KeptPrograms, key_of, numbers_of
from distal.editor.scene_folder import check_name, encoded_text
from distal.export.page_options import PageOptions
from distal.export.page_programs import framed, lowered
from distal.export.payload import Facts, parameter_entry, payload
from distal.ir.nodes import Module, Origin
from distal.lang.chosen_values import checked_values
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.lang.parameters import Parameter, slider
from distal.load_watch import LoadWatch
from distal.loading import LoadedFile, load_text
from distal.runtime.standard_executor import reads_time
from distal.scene.viewing.viewable import COLOR, Viewable, view_label, viewable

HELD: Final = "held_value"
# A held number has a slider from so many times below its size to as many above.
_REACH: Final = 1000.0


class Looks:
    """Loads scenes and compiles their views.

    Args:
        folder: Where the modules beside the scene's file are put.
        tell: Sends a message before the answer.
    """

    def __init__(
        self, folder: Path, tell: Callable[[Progress | Printed], None] = lambda _: None
    ) -> None:
        self._folder, self._tell = folder, tell
        self._written: dict[str, str] = {}
        self._programs = KeptPrograms()

    def load(
        self,
        request: SourceRequest,
        files: Mapping[str, str],
        given: Mapping[str, Any] | None = None,
    ) -> tuple[LoadedFile, Viewable]:
        """Run the author's files.

        Args:
            request: What names the object, the look and the mode.
            files: The texts.
            given: Global names that the scene's file may use without defining them.

        Raises:
            LoadError: A file fails when run, or there is no such object.
            CompileError: A file is not Python, or the scene has mistakes.
        """
        self._put(files, request.main)
        file = self._folder / request.main
        with LoadWatch(file, lambda found: self._hangs(request, found)):
            loaded = load_text(file, files[request.main], request.object, given)
        obj = loaded.picture
        # From here on no code of the author runs, except functions that compute numbers.
        self._tell(Progress(**request.numbers, done=0.0, label="compiling"))
        seen = viewable(obj, self._values_of(obj, request), request.time, request.look)
        return loaded, seen.in_mode(request.mode)

    def _hangs(self, request: SourceRequest, found: Diagnostic) -> None:
        """Tell where the author's code is; whoever started the worker may end it."""
        place, span = "", found.span
        if span is not None:
            span = replace(span, file=Path(span.file).name)
            place = f"line {span.line} of {span.file}: {span.text.strip():.80}"
        text = replace(found, span=span, hint=None).text("warning")
        self._tell(Printed(**request.numbers, text=f"{text}\n", hangs=place))

    @staticmethod
    def _values_of(obj: Any, request: SourceRequest) -> dict[str, Any]:
        """Return the values of the parameters that a lone shape has; others are of other texts."""
        if not request.values or not isinstance(obj, Composed):
            return {}
        return known_values(obj.parameters(), request.values)

    def _put(self, files: Mapping[str, str], main: str) -> None:
        """Write the modules beside the scene's file, and remove those that are gone."""
        for name in {*files, *self._written}:
            check_name(name)
            if self._written.get(name) == files.get(name):
                continue
            if name in files:
                (self._folder / name).write_bytes(encoded_text(name, files[name]))
                self._written[name] = files[name]
            else:
                (self._folder / name).unlink(missing_ok=True)
                del self._written[name]

    def look(
        self,
        request: LookRequest,
        files: Mapping[str, str],
        edits: tuple[Edit, ...],
        literals: tuple[SourceLiteral, ...] | None,
        begin: float,
    ) -> SceneFound | NumbersFound:
        """Return the answer of a ``look``.

        Args:
            request: The request.
            files: The texts with its changes made.
            edits: The edits that made them.
            literals: The literals of the texts, if they are wanted.
            begin: When the work began.
        """
        loaded, seen = self.load(request, files)
        loaded_at = time.perf_counter()
        module = _lowered(seen, request.view)
        key = key_of(module)
        common: dict[str, Any] = {
            **request.numbers,
            **{"key": key, "edits": edits, "literals": literals},
        }
        if request.lean and key == request.known:
            return NumbersFound(
                **common,
                numbers=numbers_of(module),
                parameters=tuple(parameter_entry(p) for p in _parameters_of(module)),
                ms=_times(begin, loaded_at),
            )
        content = self._content(seen, request, module, key, guided=request.guided)
        shapes: tuple[ShapePlace, ...] | None = None
        if not request.lean:
            shapes = () if seen.scene is None else shapes_of(seen.scene, files)
        return SceneFound(
            **common,
            payload=content,
            objects=loaded.names,
            shapes=shapes,
            ms=_times(begin, loaded_at),
        )

    def hold(self, request: HoldRequest, begin: float) -> SceneFound:
        """Return the program in which a number of the text is an input.

        Raises:
            LiteralError: There is no literal.
        """
        text = request.files.get(request.file, "")
        literal = literal_at(find_literals(request.file, text), request.start, request.end)
        held, files, given = None, dict(request.files), None
        if literal.way == "hold" and request.file == request.main:
            edit = Edit(file=request.file, start=literal.start, end=literal.end, text=HELD)
            files, held = applied(files, (edit,)), HELD
            value = cast(float, literal.value)
            reach = _REACH * max(abs(value), literal.step)
            given = {HELD: slider(HELD, value, low=value - reach, high=value + reach)}
        try:
            loaded, seen = self.load(request, files, given)
            module = _lowered(seen, request.view)
            key = key_of(module)
            content = self._content(seen, request, module, key)
        except (CompileError, LoadError):
            if held is None:
                raise
            # It steers what is compiled, such as the bound of a loop.
            held = None
            loaded, seen = self.load(request, request.files)
            module = _lowered(seen, request.view)
            key = key_of(module)
            content = self._content(seen, request, module, key)
        return SceneFound(
            **request.numbers,
            key=key,
            payload=_without_held(content) if held else content,
            objects=loaded.names,
            held=held,
            ms=_times(begin, begin),
        )

    def _content(
        self,
        seen: Viewable,
        request: SourceRequest,
        module: Module,
        key: str,
        *,
        guided: bool = True,
    ) -> dict[str, Any]:
        """Return the payload of a view, with all views listed."""
        if request.view not in seen.views and not request.view.startswith("local:"):
            raise ValueError(
                f"there is no view '{request.view[:40]}'; views: {', '.join(seen.views)}"
            )
        chosen = _image(seen, request.view)

        def compiled(image: Func | Composed) -> Any:
            if image is chosen:
                return self._programs.of(module, key), module
            return self._programs.compiled(image)

        # Those of the picture: a view may read fewer, and no time; its buffers may read more.
        if request.view == COLOR and not seen.keeps_frames:
            facts = Facts(_parameters_of(module), reads_time(module))
        else:
            facts = Facts(seen.parameters, seen.animated)
        options = PageOptions(
            size=request.size,
            time=request.time,
            params=known_values(facts.parameters, request.values),
            view=request.view,
            views=[request.view],
            poster=False,
        )
        content = payload(seen, options, compile=compiled, packed=False, facts=facts, guided=guided)
        shown = {view["name"]: view for view in content["views"]}
        content["views"] = [
            shown.get(name, {"name": name, "label": view_label(name), "program": -1})
            for name in dict.fromkeys((*seen.views, *shown))
        ]
        return content


def known_values(parameters: Any, values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of parameters that there still are, and that still are in their ranges."""
    found: dict[str, Any] = {}
    for parameter in parameters:
        if parameter.name in values:
            try:
                given = {parameter.name: values[parameter.name]}
                found |= checked_values([parameter], given)
            except (ValueError, TypeError):
                continue  # the author has changed the declaration
    return found


def _image(seen: Viewable, view: str) -> Any:
    # As ``PagePrograms.add`` asks for it; the scene keeps its views.
    return seen.image(view, steered=seen.steers, encoded=True, sampled=seen.is_sampled(view))


def _lowered(seen: Viewable, view: str) -> Module:
    """Return the IR of a view; that of an ``@image`` also tells which locals can be shown."""
    if seen.scene is None and view == COLOR:
        return framed(seen.lowered)
    return lowered(_image(seen, view))


def _parameters_of(module: Module) -> list[Parameter]:
    return [u.source for u in module.uniforms if u.origin is Origin.PARAMETER]


def _without_held(content: dict[str, Any]) -> dict[str, Any]:
    """Return a payload whose held number is not among the parameters that people see."""
    uniforms = (u for program in content["programs"]["data"] for u in program["uniforms"])
    for uniform in uniforms:
        if uniform["name"] == HELD:
            uniform["origin"] = Origin.NUMBER.value
    content["parameters"] = [p for p in content["parameters"] if p["name"] != HELD]
    return content


def _times(begin: float, loaded: float) -> dict[str, float]:
    end = time.perf_counter()
    stages = {"load": loaded - begin, "compile": end - loaded, "all": end - begin}
    return {name: round(1000.0 * seconds, 1) for name, seconds in stages.items()}


def mistakes_of(error: Exception, files: Mapping[str, str]) -> tuple[Mistake, ...]:
    """Return an error of the author's code with its places.

    Args:
        error: A ``CompileError``, a ``LoadError`` or a ``DeviceError``.
        files: The author's files; places elsewhere are left out.
    """
    if isinstance(error, CompileError | LoadError):
        return tuple(mistake_at(d, files) for d in error.diagnostics)
    return (Mistake(severity="error", message=str(error)),)


def mistake_at(
    found: Diagnostic,
    files: Mapping[str, str],
    severity: Literal["error", "warning", "note"] = "error",
) -> Mistake:
    """Return a diagnostic as a mistake; a place outside of the author's files is left out."""
    labels = [(_own(label.span, files), label.text) for label in found.labels]
    kept = tuple(Label(span, text) for span, text in labels if span is not None)
    values = replace(found, span=_own(found.span, files), labels=kept).to_json()
    shown = tuple(MistakeLabel(**label) for label in values.pop("labels"))
    return Mistake(severity=severity, **values, labels=shown)


def _own(span: Span | None, files: Mapping[str, str]) -> Span | None:
    """Return a place in the author's files, without folders; None for a place elsewhere."""
    if span is None or PurePath(span.file).name not in files:
        return None
    return replace(span, file=PurePath(span.file).name)
