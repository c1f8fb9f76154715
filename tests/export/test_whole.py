"""What a text reads is carried by its export, or the export is refused with the author's line.

A host that knows the exported files alone draws them (``consumer``); its picture is the CPU's.
``make sweep`` sets ``DISTAL_ALL_PICTURES=1`` and draws every example by every target that has an
interface, which takes ten minutes.
"""

from __future__ import annotations

import json
import os
import random
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import distal
from distal.backends import TEXT_TARGETS
from distal.frontend import lower
from distal.ir.types import TextureShape
from tests import egl, gpu
from tests.export import consumer
from tests.pictures.comparison import difference

SIZE = (48, 36)
DESCRIBED = [name for name, target in TEXT_TARGETS.items() if target.is_described]
WITH_BUFFERS = [name for name in DESCRIBED if TEXT_TARGETS[name].buffers]
ALL = os.environ.get("DISTAL_ALL_PICTURES") == "1"

READS = """
from distal.lang import *
import numpy as np

floats = Buffer([{floats}])
points = Buffer([{points}])
counts = Buffer([{counts}])
table = tuple({start} + {step} * i for i in range({length}))
photo = Texture2D("photo.png")
heights = Texture2D(np.linspace(-{high}, {high}, 64, dtype=np.float32).reshape(8, 8))
{more_data}
amount = slider("Amount", {amount}, 0.0, 1.0)
tint = color("Tint", "{tint}")
mode = choice("Mode", ["one", "two", "three"], {mode})
is_on = toggle("On", {is_on})
spot = point("Spot", ({x}, {y}, 0.25))


@func
def wave(x: float, scale: float = {scale}) -> float:
    return 0.5 + 0.5 * sin(x * scale)


@image
def picture(frame: Frame) -> vec3:
    uv = frame.coord / frame.resolution
    i = int(frame.coord.x) % len(floats)
    shown = tint * floats[i] + points[int(frame.coord.y) % len(points)]
    shown += vec3(0.1 * float(counts[i % len(counts)]), table[int(frame.coord.x) % {length}], 0.0)
    shown = mix(shown, sample(photo, uv).rgb, amount) + 0.1 * sample(heights, uv).rgb
    shown += {more}
    shown += 0.1 * wave(frame.time + uv.x) + 0.1 * float(mode) + spot * (0.1 if is_on else 0.2)
    return 0.25 * shown
"""
VOLUME = "volume = Texture3D(np.arange(27.0).reshape(3, 3, 3) / 26.0)"
CUBE = "cube = TextureCube([np.full((2, 2, 3), 0.1 * face) for face in range(6)])"


def written(folder: Path, seed: int):
    """A random picture that reads every kind of thing, loaded from a file."""
    draw = random.Random(seed)
    number = lambda: round(draw.uniform(-1.0, 1.0), 3)  # noqa: E731
    more_data, more = draw.choice(
        [
            (VOLUME, "sample(volume, vec3(uv, 0.5)).rgb"),
            (CUBE, "sample(cube, vec3(uv - 0.5, 0.3)).rgb"),
            ("", "vec3(0.0)"),
        ]
    )
    values = {
        "floats": ", ".join(str(number()) for _ in range(draw.randint(1, 9))),
        "points": ", ".join(f"({number()}, {number()}, {number()})" for _ in range(5)),
        "counts": ", ".join(str(draw.randint(-9, 9)) for _ in range(3)),
        "length": draw.choice([5, 64, 300]),
        "tint": f"#{draw.randrange(1 << 24):06x}",
        "mode": draw.randrange(3),
        "is_on": draw.random() < 0.5,
        "amount": draw.random(),
        **{name: number() for name in ("start", "step", "x", "y", "high", "scale")},
    }
    levels = np.random.default_rng(seed).integers(0, 256, (4, 6, 4), np.uint8)
    levels[..., 3] = 255
    Image.fromarray(levels).save(folder / "photo.png")
    text = READS.format(more_data=more_data, more=more, **values)
    (folder / "reads.py").write_text(text, encoding="utf-8")
    return distal.load(folder / "reads.py")


def compare(obj, folder: Path, target: str, name: str = "", time: float = 0.5) -> None:
    """The picture that the exported files give is that of the CPU."""
    path = folder / f"out.{target}.txt"
    obj.export(path, target=target)
    try:
        shown = consumer.drawn(path, SIZE, time)
    except (egl.EglUnavailableError, gpu.GpuUnavailableError) as error:
        pytest.skip(str(error))
    options = {"mode": "direct"} if isinstance(obj, distal.Scene) else {}
    expected = obj.render(SIZE, samples=1, time=time, **options)
    found = difference(expected.array, shown)
    assert found.is_agreement_of(name), found
    assert float(as_float(expected.array).std()) > 0.01, "a picture of one color shows nothing"


def as_float(pixels):
    return np.asarray(pixels, np.float32)[..., :3]


@pytest.mark.parametrize(
    ("seed", "target"),
    [
        (seed, target)
        for seed in range(32)
        for number, target in enumerate(WITH_BUFFERS)
        if ALL or seed == number
    ],
)
def test_all_that_a_picture_reads_is_exported(tmp_path, seed, target):
    compare(written(tmp_path, seed), tmp_path, target)


# Without buffers the text is the whole tree, 1,600 bricks: Mesa's compiler takes over 20 GB.
TOO_LARGE = {("bricks", "glsl-es100"), ("ripples", "glsl-es100")}
# Mesa's lavapipe clips the triangle to two: along their common side its pixels lose shadows.
LAVAPIPE = pytest.mark.xfail(reason="pixels along the diagonal of lavapipe's triangles")
OF_DRIVERS = {("beach", "wgsl"): LAVAPIPE, ("forest", "wgsl"): LAVAPIPE}


@pytest.mark.parametrize(
    ("name", "target"),
    [
        pytest.param(name, target, marks=OF_DRIVERS.get((name, target), ()))
        for name in (sorted(distal.gallery()) if ALL else ["raymarcher"])
        for target in DESCRIBED
        if (name, target) not in TOO_LARGE
    ],
)
def test_examples_are_drawn_from_their_files(tmp_path, name, target):
    try:
        compare(distal.load(f"example:{name}"), tmp_path, target, name)
    except distal.CompileError as error:
        assert error.diagnostics[0].span is not None, error


def test_a_text_of_a_scene_of_paths_says_that_it_is_direct_light(tmp_path):
    with pytest.warns(UserWarning, match="a text draws direct light, and the scene is in mode"):
        distal.load("example:prism").export(tmp_path / "out.glsl", target="glsl-es300")


BALLS = """
from distal import Scene, Sphere, union

balls = [Sphere(0.1).translate(0.3 * (i % 20), 0.0, 0.3 * (i // 20)) for i in range(300)]
scene = Scene(union(*balls))
"""


@pytest.mark.parametrize("target", WITH_BUFFERS)
def test_the_table_of_a_union_is_exported(tmp_path, target):
    (tmp_path / "balls.py").write_text(BALLS, encoding="utf-8")
    path = tmp_path / "out.txt"
    distal.load(tmp_path / "balls.py").export(path, target=target)
    entries = {e["name"]: e for e in json.loads(path.with_suffix(".json").read_text())["buffers"]}
    assert set(entries) == {"part_rows", "part_boxes", "part_distances"}
    rows = consumer.numbers(entries["part_rows"])
    places = {(round(0.3 * (i % 20), 3), round(0.3 * (i // 20), 3)) for i in range(300)}
    found = {(round(float(row[0]), 3), round(float(row[2]), 3)) for row in rows}
    assert places <= found


HEAD = "from distal.lang import *\n\n"
PICTURE = "\n\n@image\ndef picture(frame: Frame) -> vec3:\n"
VALUE = "    return vec3(float({}))\n"
# (declaration, value, targets, message, hint); the value is in line 7.
REFUSED = [
    (
        "data = Buffer([1.0, 2.0])",
        "data[int(frame.coord.x) % 2]",
        ("shadertoy", "glslcanvas", "isf", "glsl-es100"),
        "{host} has no buffers, and 'data' is read here",
        "targets that have it: glsl-es300, glsl-330, wgsl, wgsl-compute, html",
    ),
    (
        "data = Texture3D([[[1.0, 0.0]]])",
        "sample(data, vec3(0.5)).x",
        ("glslcanvas", "isf", "glsl-es100"),
        "{host} has no 3D textures, and 'data' is read here",
        "targets that have it: shadertoy, glsl-es300, glsl-330, wgsl, wgsl-compute, html",
    ),
    (
        "data = Texture3D([[[1.0, 0.0]]])",
        "sample(data, vec3(0.5)).x",
        ("shadertoy",),
        "{host} reads pictures of 8 bits from files, and 'data' has the type Texture3D",
        "targets that have it: glsl-es300, glsl-330, wgsl, wgsl-compute, html",
    ),
    (
        "data = Texture2D([[0.0, 0.3, 12.5]])",
        "sample(data, vec2(0.5)).x",
        ("shadertoy", "glslcanvas", "isf"),
        "{host} reads pictures of 8 bits from files, and 'data' has numbers that 8 bits cannot "
        "hold",
        "targets that have it: glsl-es300, glsl-330, wgsl, wgsl-compute, html",
    ),
    (
        "",
        "sample(keyboard, vec2(0.5)).x",
        ("glslcanvas", "isf", "glsl-es100", "glsl-es300", "glsl-330", "wgsl", "wgsl-compute"),
        "{host} has no keyboard, and 'keyboard' is read here",
        "targets that have it: shadertoy, html",
    ),
    (
        "data = Buffer([1.0, 1e39])",
        "data[int(frame.coord.x) % 2]",
        WITH_BUFFERS,
        "number 1 of 'data' is inf as a 32-bit float, which a shader cannot hold",
        "replace it in the data by a finite number of at most 3.4e38",
    ),
    (
        "data = Buffer([float('nan'), 1.0])",
        "data[int(frame.coord.x) % 2]",
        WITH_BUFFERS,
        "number 0 of 'data' is nan as a 32-bit float, which a shader cannot hold",
        "replace it in the data by a finite number of at most 3.4e38",
    ),
    (
        "data = Buffer([1, 1 << 40])",
        "data[int(frame.coord.x) % 2]",
        WITH_BUFFERS,
        "the data of 'data' cannot be exported: a value of the buffer does not fit int",
        None,
    ),
    (
        "data = Texture2D('missing.png')",
        "sample(data, vec2(0.5)).x",
        WITH_BUFFERS,
        None,
        None,
    ),
    (
        "",
        "frame.coord.x * 1e-40",
        tuple(TEXT_TARGETS),
        "GPUs read 1e-40 as 0: the smallest number in a shader is 1.18e-38",
        "write 0.0, or scale the numbers",
    ),
    (
        "tiny = slider('Tiny', 1e-39, 0.0, 1.0)",
        "tiny",
        tuple(TEXT_TARGETS),
        "GPUs read 1e-39 ('tiny') as 0: the smallest number in a shader is 1.18e-38",
        "write 0.0, or scale the numbers",
    ),
    (
        "big = 1e30",
        "min(big * big * frame.coord.x, 1.0)",
        tuple(TEXT_TARGETS),
        "this is 1e+60, and the largest number in a shader is 3.4e+38",
        "scale the numbers so that products and sums stay below it",
    ),
]


@pytest.mark.parametrize(
    ("data", "value", "target", "message", "hint"),
    [
        (data, value, target, message, hint)
        for data, value, targets, message, hint in REFUSED
        for target in targets
    ],
)
def test_what_a_text_cannot_hold_is_refused_with_its_line(
    tmp_path, data, value, target, message, hint
):
    file = tmp_path / "scene.py"
    file.write_text(f"{HEAD}{data}{PICTURE}{VALUE.format(value)}", encoding="utf-8")
    picture = distal.load(file)
    with pytest.raises(distal.CompileError) as refused:
        picture.export(tmp_path / "out.txt", target=target)
    (found,) = refused.value.diagnostics
    assert (Path(found.span.file).name, found.span.line) == ("scene.py", 7)
    if message is not None:
        assert found.message == message.format(host=TEXT_TARGETS[target].host)
        assert found.hint == hint
    assert list(tmp_path.iterdir()) == [file]


@pytest.mark.parametrize(
    ("given", "name"),
    [
        ("camera=Camera(target=(0, 0, 1e-40))", "Camera_target"),
        ("lights=[PointLight(position=(1e-40, 3, 3))]", "PointLight_position"),
        ("background=(1e-40, 0, 0)", "Background_color"),
        ("exposure=1e-40", "Exposure"),
    ],
)
def test_a_number_of_a_scene_is_refused_with_the_line_of_the_scene(tmp_path, given, name):
    file = tmp_path / "scene.py"
    file.write_text(f"from distal import *\n\nscene = Scene(Sphere(1), {given})\n", "utf-8")
    with pytest.raises(distal.CompileError) as refused:
        distal.compile(distal.load(file), "wgsl")
    (found,) = refused.value.diagnostics
    assert found.message.startswith(f"GPUs read 1e-40 ('{name}') as 0: ")
    assert (Path(found.span.file).name, found.span.line) == ("scene.py", 3)


def test_a_number_of_two_scenes_is_refused_with_the_line_of_each(tmp_path):
    kept = []  # so that equal expressions of both scenes are one object
    for lines in range(3):
        file = tmp_path / f"scene{lines}.py"
        file.write_text(
            "#\n" * lines + f"{HEAD}big = 1e30{PICTURE}{VALUE.format('big * big')}",
            encoding="utf-8",
        )
        kept.append(distal.load(file))
        kept.append(lower(kept[-1]))
        with pytest.raises(distal.CompileError) as refused:
            distal.compile(kept[-2], "wgsl")
        (found,) = refused.value.diagnostics
        assert (Path(found.span.file).name, found.span.line) == (file.name, 7 + lines)


def test_what_the_library_needs_is_refused_with_the_authors_line(tmp_path):
    file = tmp_path / "scene.py"
    file.write_text(
        "import numpy as np\nfrom distal import Heightfield, Scene\n\n"
        "hills = Heightfield(np.eye(4), size=(1.0, 1.0), height=0.5)\nscene = Scene(hills)\n",
        encoding="utf-8",
    )
    with pytest.raises(distal.CompileError) as refused:
        distal.load(file).export(tmp_path / "out.txt", target="glsl-es100")
    (found,) = refused.value.diagnostics
    assert found.message == "glsl-es100 has no texture sizes, which the library needs here"
    assert (Path(found.span.file).name, found.span.line) == ("scene.py", 4)


def test_one_text_of_several_passes_is_refused(tmp_path):
    coral = distal.load("example:coral")
    with pytest.raises(distal.CompileError, match="one text is one pass") as refused:
        distal.compile(coral, "shadertoy")
    assert Path(refused.value.diagnostics[0].span.file).name == "coral.py"


FUNCTION = """
from distal.lang import *

softness = slider("Softness", 0.25, 0.05, 1.0)
is_on = toggle("On", True)
data = Buffer([1.0, 2.0, 3.0])


@func
def f(x: float) -> float:
    return softness * x + data[2] if is_on else x
"""


def test_a_function_in_wgsl_reads_its_parameters(tmp_path):
    """In a shader of someone else, by the bindings and offsets of its interface."""
    (tmp_path / "f.py").write_text(FUNCTION, encoding="utf-8")
    artifact = distal.compile(distal.load(f"{tmp_path / 'f.py'}:f"), "wgsl")
    interface = artifact.interface
    own = (
        "@group(2) @binding(0) var<storage, read_write> shown: array<f32, 2>;\n"
        "@compute @workgroup_size(1) fn go() { shown[0] = "
        f"{interface['entry']}(4.0); shown[1] = {interface['entry']}(8.0); }}\n"
    )
    try:
        device = gpu.device()
    except gpu.GpuUnavailableError as error:
        pytest.skip(str(error))
    usage = gpu.wgpu.BufferUsage
    shown = device.create_buffer(size=8, usage=usage.STORAGE | usage.COPY_SRC)
    values = device.create_buffer_with_data(
        data=gpu.uniform_bytes(artifact, (1, 1), {}), usage=usage.UNIFORM
    )
    (entry,) = interface["buffers"]
    numbers = device.create_buffer_with_data(data=consumer.numbers(entry), usage=usage.STORAGE)
    assert entry["stride"] == 4 and (entry["group"], entry["binding"]) == (1, 0)
    pipeline = device.create_compute_pipeline(
        layout="auto",
        compute={"module": device.create_shader_module(code=artifact.text + own)},
    )
    encoder = device.create_command_encoder()
    step = encoder.begin_compute_pass()
    step.set_pipeline(pipeline)
    for group, buffer in enumerate((values, numbers, shown)):
        bound = {"binding": 0, "resource": {"buffer": buffer, "offset": 0, "size": buffer.size}}
        layout = pipeline.get_bind_group_layout(group)
        step.set_bind_group(group, device.create_bind_group(layout=layout, entries=[bound]))
    step.dispatch_workgroups(1)
    step.end()
    device.queue.submit([encoder.finish()])
    found = np.frombuffer(device.queue.read_buffer(shown), np.float32)
    assert found.tolist() == [0.25 * 4.0 + 3.0, 0.25 * 8.0 + 3.0]


def test_pictures_beside_a_text_are_never_the_authors(tmp_path):
    written(tmp_path, 0)
    before = (tmp_path / "photo.png").read_bytes()
    small = "from distal.lang import *\n\nphoto = Texture2D('photo.png')\n" + PICTURE
    small += "    return sample(photo, frame.coord / frame.resolution).rgb\n"
    (tmp_path / "small.py").write_text(small, encoding="utf-8")
    picture = distal.load(tmp_path / "small.py")
    made = picture.export(tmp_path / "photo.glsl")
    assert [path.name for path in made.beside] == ["photo.iChannel0.png"]
    assert (tmp_path / "photo.png").read_bytes() == before
    assert "photo.iChannel0.png" in (tmp_path / "photo.glsl").read_text()


def test_the_guide_says_what_each_target_carries():
    """Its table is that of the declarations."""
    guide = (Path(__file__).parents[2] / "docs/guide/web.md").read_text(encoding="utf-8")
    kinds = {TextureShape.FLAT: "2D", TextureShape.CUBE: "cube", TextureShape.VOLUME: "3D"}
    for name, target in TEXT_TARGETS.items():
        shapes = [word for shape, word in kinds.items() if shape in target.textures]
        if target.is_described:
            data = f"{', '.join(shapes)}: in the `.json`"
        else:
            most = f", {target.most_textures} at most" if target.most_textures else ""
            data = f"2D of 8 bits: a `.png` beside{most}"
        buffers = "in the `.json`" if target.buffers else "refused"
        live = "channels" if target.live else "refused"
        assert f"| `{name}` | {buffers} | {data} | {live} |" in guide
