"""The requests that are answered by one result: edits, texts, exports, checks, pixels.

Input: a request, and what loads its scene. Output: its result.
"""

from __future__ import annotations

import base64
import io
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import PurePath
from typing import Any, Final, Literal, cast

from distal.backends import TEXT_TARGETS
from distal.compiler.driver import compile as compile_text
from distal.editor.commands import PAGE, export_arguments, file_stem, shown
from distal.editor.counting import counting, timing
from distal.editor.edits import edits_of
from distal.editor.looks import Looks, known_values, mistake_at
from distal.editor.messages import (
    Checked,
    CountRequest,
    EmittedText,
    ExportedFile,
    ExportRequest,
    ProbeRequest,
    ProbeResult,
    Result,
    SourceRequest,
    TextRequest,
    WriteRequest,
    Written,
)
from distal.editor.shape_map import shape_map
from distal.export import page, shadertoy, texts
from distal.export.page_options import PageOptions, TextOptions
from distal.lang.lazy_module import LazyModule
from distal.scene.objects.field import BaseShape
from distal.scene.steering import Steering

probing: Final = cast(Any, LazyModule("distal.scene.checks.probe"))  # needs NumPy
validation: Final = cast(Any, LazyModule("distal.scene.checks.validation"))
NEEDS_NUMPY: Final = frozenset({"check", "probe"})


@dataclass(frozen=True, slots=True)
class AnswerWork:
    """A request, and what loads its scene."""

    request: SourceRequest
    looks: Looks


def _write(work: AnswerWork) -> Result:
    request = cast(WriteRequest, work.request)
    return Written(edits=edits_of(request.files, request.main, request.changes))


def _text(work: AnswerWork) -> Result:
    request = cast(TextRequest, work.request)
    _, seen = work.looks.load(request, request.files)
    artifact = compile_text(seen.image(request.view, encoded=True), target=request.target)
    files = tuple(request.files)
    places: list[tuple[int, int, int, int]] = []
    for number, origin in enumerate(artifact.lines, start=1):
        name = PurePath(origin[0]).name if origin is not None else ""
        if origin is None or name not in request.files:
            continue
        place = (number, number, files.index(name), origin[1])
        if places and places[-1][1:] == (number - 1, *place[2:]):
            place = (places.pop()[0], *place[1:])
        places.append(place)
    return EmittedText(
        target=request.target,
        language=_language(request.target),
        text=artifact.text,
        files=files,
        places=tuple(places),
    )


def _language(target: str) -> Literal["glsl", "wgsl", "llvm", "ir"]:
    if target in ("llvm", "ir"):
        return cast(Literal["llvm", "ir"], target)
    return "wgsl" if target.startswith("wgsl") else "glsl"


def _export(work: AnswerWork) -> Result:
    request = cast(ExportRequest, work.request)
    _, seen = work.looks.load(request, request.files)
    params = known_values(seen.parameters, request.values)
    stem = file_stem(request)
    if request.format == PAGE:
        options = PageOptions(
            size=request.size,
            time=request.time,
            params=params,
            view=request.view,
            title=request.title,
            embed=request.embed,
            poster=False,
        )
        poster = base64.b64decode(request.poster or "")
        made = page.page(seen, options, poster, "png")
        name = f"{stem}-embed.html" if request.embed else f"{stem}.html"
        return ExportedFile(
            name=name,
            media_type="text/html",
            text=made.text,
            command=shown(export_arguments(request, name)),
        )
    if request.format not in TEXT_TARGETS:
        known = ", ".join((PAGE, *TEXT_TARGETS))
        raise ValueError(f"there is no format '{request.format[:40]}'; formats: {known}")
    suffix = TEXT_TARGETS[request.format].suffix or ".txt"
    values = TextOptions(params=params, time=request.time, view=request.view)
    name = f"{stem}{suffix}"
    command = shown(export_arguments(request, name))
    if request.format == shadertoy.TARGET and shadertoy.has_passes(seen, values):
        files = dict(shadertoy.tabs_of(seen, PurePath(name), values))
    else:
        made_text = texts.text_files(seen, request.format, values, stem)
        files = {name: texts.text_bytes(made_text.text), **made_text.beside}
    if len(files) == 1:
        text = files[name].decode()
        return ExportedFile(name=name, media_type="text/plain", text=text, command=command)
    # A browser saves one file for one click.
    packed = base64.b64encode(_archive(files)).decode()
    name = f"{stem}.{request.format}.zip"
    return ExportedFile(name=name, media_type="application/zip", base64=packed, command=command)


def _archive(files: Mapping[str, bytes]) -> bytes:
    """Return a ZIP of files; the same files always give the same bytes."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            entry = zipfile.ZipInfo(name)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, content)
    return packed.getvalue()


def _check(work: AnswerWork) -> Result:
    request = work.request
    loaded, seen = work.looks.load(request, request.files)
    subject = seen.scene.subject if seen.scene is not None else loaded.picture
    if not isinstance(subject, BaseShape):
        raise ValueError("scenes and shapes are checked; this is an @image")
    values = known_values(subject.parameters(), request.values)
    report = validation.check(subject, values, request.time)
    return Checked(
        mistakes=tuple(
            mistake_at(f.diagnostic, request.files, _SEVERITIES.get(f.severity.value, "note"))
            for f in report.findings
        )
    )


def _probe(work: AnswerWork) -> Result:
    request = cast(ProbeRequest, work.request)
    _, seen = work.looks.load(request, request.files)
    if seen.scene is None:
        raise ValueError("pixels of scenes and shapes are probed; this is an @image")
    values = known_values(seen.parameters, request.values)
    pixel = (int(request.x), int(request.y))
    moved = Steering.of(request.steering) if request.steering else None
    found = probing.probe(seen.scene, pixel, request.size, values, request.time, moved)
    if not found.hit:
        return ProbeResult(numbers={"steps": float(found.seen.steps)})
    shape = found.path[-1]
    span = shape.place
    known = span is not None and PurePath(span.file).name in request.files
    return ProbeResult(
        shape=shape.name,
        material=str((found.as_json()["material"] or {}).get("name") or ""),
        file=PurePath(span.file).name if known else None,
        line=span.line if known else None,
        point=tuple(map(float, found.seen.p)),
        normal=tuple(map(float, found.seen.normal)),
        numbers={"steps": float(found.seen.steps), "distance": float(found.seen.t)},
    )


_SEVERITIES: Final[Mapping[str, Literal["error", "warning", "note"]]] = {
    "error": "error",
    "warning": "warning",
}


def _count(work: AnswerWork) -> Result:
    request = cast(CountRequest, work.request)
    _, seen = work.looks.load(request, request.files)
    return counting(seen, request.view, tuple(request.files), work=request.work)


def _time(work: AnswerWork) -> Result:
    _, seen = work.looks.load(work.request, work.request.files)
    return timing(seen, work.request.view, tuple(work.request.files))


def _map(work: AnswerWork) -> Result:
    _, seen = work.looks.load(work.request, work.request.files)
    if seen.scene is None:
        raise ValueError("scenes and shapes have parts; this is an @image")
    return shape_map(seen, tuple(work.request.files))


ANSWERS: Final[Mapping[str, Callable[[AnswerWork], Result]]] = {
    "write": _write,
    "probe": _probe,
    "count": _count,
    "time": _time,
    "map": _map,
    "check": _check,
    "text": _text,
    "export": _export,
}
