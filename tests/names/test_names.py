"""No name of an author's changes what a text means, whatever the text itself or its host uses.

The words come from the texts: what stands in one without being the author's is taken as a name of
everything. With them come the keywords and built-ins of the target, and what its host declares. So
a name that a writer begins to use is tested here without being listed.
"""

from __future__ import annotations

import shutil
import subprocess
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from distal.backends import emit, get_target
from distal.backends.base import Artifact
from distal.backends.glsl.backend import vocabulary
from distal.backends.glsl.targets import GlslTarget
from distal.backends.numpy import interpreter as reference
from distal.backends.wgsl.names import VOCABULARY
from distal.compiler.driver import run_passes
from distal.devices import cpu as cpu_device
from distal.devices.cache import Cache
from distal.ir.nodes import Module
from tests.names.binding import conflicts, identifiers, tokens
from tests.names.programs import (
    BUFFERS,
    FAMILIES,
    PLAIN,
    THINGS,
    artifacts,
    can_be_named,
    function_source,
    hostile,
    in_pairs,
    lowered,
    picture_source,
    plain,
    plain_picture,
    textures_source,
)

SIZE = (7, 3)
# Whose text is given to its compiler: the others' differs in what their hosts declare.
ACCEPTING = frozenset({"glsl-es300", "glsl-330", "shadertoy", "glsl-es100", "wgsl"})
FAULTS = ("frame", "frame_", "frame__")  # what hid WGSL's own variable


def texts(artifact: Artifact) -> list[str]:
    return [text for text in (artifact.text, artifact.vertex) if text is not None]


@cache
def words_of_texts() -> frozenset[str]:
    """What all targets write into a text besides the author's names, and variants of it."""
    found: set[str] = set()
    for family in FAMILIES:
        for artifact in plain_picture(family, THINGS).values():
            found |= {n for text in texts(artifact) for n in identifiers(text) if PLAIN not in n}
    for artifact in plain_functions().values():
        found |= {n for n in identifiers(artifact.text) if PLAIN not in n}
    return frozenset(filter(can_be_named, found | set(FAULTS)))


@cache
def plain_functions() -> dict[str, Artifact]:
    return artifacts(lowered(function_source(plain)), FAMILIES[-1])


def reserved(target: str) -> frozenset[str]:
    """The words that the target's own vocabulary lists."""
    found = get_target(target)
    names = vocabulary(found).names if isinstance(found, GlslTarget) else VOCABULARY.names
    return frozenset(filter(can_be_named, {*names.words, *names.prefixes, *names.parts}))


def batches(family: tuple[str, ...]) -> list[list[str]]:
    """All words for a family of targets, and what its own would be called a second time."""
    listed = frozenset[str]().union(*map(reserved, family))
    if family[0] in ("glsl-330", "shadertoy"):
        listed -= reserved("glsl-es300")  # one list for all versions of the language
    words = sorted(listed | words_of_texts() | {f"{w}_2" for w in words_of_texts() - listed})
    words += words[: -len(words) % (2 * THINGS)]
    return [words[i : i + 2 * THINGS] for i in range(0, len(words), 2 * THINGS)]


def host_names(plain_one: Artifact, hostile_one: Artifact) -> list[tuple[str, str]]:
    """The names by which a host finds each uniform, texture and buffer, in both texts."""
    is_wgsl = plain_one.interface["target"].startswith("wgsl")
    kinds = ("textures", "buffers") if is_wgsl else ("uniforms", "textures", "buffers")
    return [
        (tokens(ours["uniform"])[0], tokens(theirs["uniform"])[0])
        for kind in kinds
        for ours, theirs in zip(plain_one.interface[kind], hostile_one.interface[kind], strict=True)
    ]


def assert_accepted(target: str, artifact: Artifact) -> None:
    """The languages' own compilers take the text; silent where they are not installed."""
    if target.startswith("wgsl"):
        if naga := shutil.which("naga"):
            words = [naga, "--stdin-file-path", "names.wgsl"]
            done = subprocess.run(
                words, input=artifact.text, capture_output=True, text=True, check=False
            )
            assert done.returncode == 0, done.stderr
    else:
        pytest.importorskip("tests.glsl").assert_valid(artifact)


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family[0])
def test_every_name_keeps_its_meaning(family: tuple[str, ...]) -> None:
    for words in batches(family):
        source = picture_source(in_pairs(words), THINGS, buffers=family[0] in BUFFERS)
        for target, found in artifacts(lowered(source), family).items():
            expected = plain_picture(family, THINGS)[target]
            given = host_names(expected, found)
            for ours, theirs in zip(texts(expected), texts(found), strict=True):
                assert list(conflicts(ours, theirs, given)) == [], (target, words)
            if target in ACCEPTING:
                assert_accepted(target, found)


def test_every_name_keeps_its_meaning_beside_a_function_for_points() -> None:
    words = sorted(words_of_texts())
    for i in range(0, len(words), 3):
        three = [words[(i + k) % len(words)] for k in range(3)]
        found = artifacts(lowered(function_source(hostile(three))), FAMILIES[-1])
        for target, expected in plain_functions().items():
            assert list(conflicts(expected.text, found[target].text)) == [], (target, three)


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family[0])
def test_textures_and_the_image_itself_keep_their_meaning(family: tuple[str, ...]) -> None:
    texels = family[0] in BUFFERS
    expected = artifacts(lowered(textures_source(plain, texels=texels)), family)
    own = {n for a in expected.values() for t in texts(a) for n in identifiers(t)}
    own -= {n for n in own if PLAIN in n} | reserved(family[0])
    words = sorted(filter(can_be_named, own | words_of_dialect(family) | {*OWN}))
    for i in range(len(words)):
        three = [words[(i + k) % len(words)] for k in range(3)]
        found = artifacts(lowered(textures_source(hostile(three), texels=texels)), family)
        for target, artifact in found.items():
            given = host_names(expected[target], artifact)
            for ours, theirs in zip(texts(expected[target]), texts(artifact), strict=True):
                assert list(conflicts(ours, theirs, given)) == [], (target, three)


def words_of_dialect(family: tuple[str, ...]) -> frozenset[str]:
    """What a GLSL text takes from its host."""
    found = [target for target in map(get_target, family) if isinstance(target, GlslTarget)]
    return frozenset[str]().union(*(target.written_names for target in found))


# What a text declares itself, and what stands in the functions that it declares.
OWN = sorted(
    {*FAULTS, "Frame", "uniforms", "pixel", "frame_output", "tile", "table", "items", "packed_0"}
    | {"index", "last", "at", "width", "coord", "value", "fragment_color", "fragColor", "chosen"}
    | {"main_2", "iResolution", "select"}
)


@cache
def own_picture() -> tuple[Module, NDArray[np.float32]]:
    """A picture of every own name in every role, and what it is by the reference."""
    module = lowered(picture_source(hostile(OWN), len(OWN), buffers=True))
    data = {r.name: np.array(r.source.data, np.float32) for r in module.resources}
    shaped = run_passes(module, get_target("numpy"))
    values = {u.name: u.default for u in shaped.uniforms}
    return module, reference.render(shaped, *SIZE, values, data)


@pytest.mark.parametrize("target", ["llvm", *sorted(BUFFERS)])
def test_pictures_are_the_references(target: str) -> None:
    """Valid text can still mean something else: what a text calls its own things is run."""
    module, expected = own_picture()
    assert np.ptp(expected) > 100.0
    data = {r.name: np.array(r.source.data, np.float32) for r in module.resources}
    if target == "llvm":
        kernel = cpu_device.prepare(module, cache=Cache(None))
        values = {u.name: u.default for u in module.uniforms}
        found = kernel.render(*SIZE, values, data)
    else:
        found = drawn(emit(run_passes(module, get_target(target)), get_target(target)), data)
    assert (found == expected).all()


def drawn(artifact: Artifact, buffers: dict[str, NDArray[np.float32]]) -> NDArray[np.float32]:
    if artifact.interface["target"].startswith("wgsl"):
        gpu = pytest.importorskip("tests.gpu")
        try:
            return gpu.run_wgsl(artifact, SIZE, buffers=buffers)
        except gpu.GpuUnavailableError as error:
            pytest.skip(str(error))
    glsl = pytest.importorskip("tests.glsl")
    try:
        return glsl.run_glsl(artifact, SIZE, buffers=buffers)
    except glsl.egl.EglUnavailableError as error:
        pytest.skip(str(error))
