"""Pages that save a part, in a real browser: files of the page against Python's mesh."""

from __future__ import annotations

import base64
import io
import re
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial import cKDTree
from typer.testing import CliRunner

import distal
from distal import Box
from distal.cli.application import application
from distal.export.page import write
from distal.export.page_options import PageOptions
from distal.export.printing import printed_node
from distal.mesh.checks import checked
from distal.mesh.extract import Extracted, extracted
from distal.mesh.kernels import FieldKernels
from distal.mesh.meshing import MeshRequest, extent_of
from distal.mesh.printable import packed_tables
from distal.polygons.reading import read_mesh
from distal.scene.viewing.viewable import Viewable, viewable
from tests.browser import SWIFTSHADER, Watched, offline_page
from tests.mesh.noise_fields import noise

CELLS = 64
# A rounded body with a bore, on a second material, above a floor without an end.
PART = """
from distal import Box, Cylinder, Plane, Scene, Sphere
from distal.lang import slider

bore = slider("Bore", 0.2, 0.1, 0.3)
body = (Sphere(0.6) - Cylinder(bore, 2.0)).paint("#3060a0")
foot = Box(1.3, 0.2, 0.9).translate(0.013, -0.6, 0.007).paint("#d07030")
scene = Scene((body | foot) | Plane(y=-0.9), floor=False)
"""
# What the page hands to the browser, and the longest time without a frame.
_WATCH = """() => {
  window.saved = [];
  const make = URL.createObjectURL;
  URL.createObjectURL = (blob) => { window.saved.push(blob); return make.call(URL, blob); };
  const player = document.querySelector("[data-distal]").distal;
  player.setResolution(0.1);
  window.gap = window.frames = 0;
  let last = performance.now();
  const next = () => {
    const now = performance.now();
    window.gap = Math.max(window.gap, now - last);
    window.frames++;
    last = now;
    requestAnimationFrame(next);
  };
  requestAnimationFrame(next);
}"""
_BYTES = """async (at) => {
  const bytes = new Uint8Array(await window.saved[at].arrayBuffer());
  let text = "";
  for (let i = 0; i < bytes.length; i += 32768)
    text += String.fromCharCode(...bytes.subarray(i, i + 32768));
  return btoa(text);
}"""
_SET = """(values) => {
  const player = document.querySelector("[data-distal]").distal;
  for (const [name, value] of Object.entries(values)) player.setParameter(name, value);
}"""
# Counts the pictures after the one that rests.
_REST = """async () => {
  const player = document.querySelector("[data-distal]").distal;
  await player.settled();
  await new Promise((resolve) => setTimeout(resolve, 500));
  window.drawn = 0;
  player.on("frame", () => window.drawn++);
}"""
_KEEP_CONTEXT = """() => {
  const own = OffscreenCanvas.prototype.getContext;
  OffscreenCanvas.prototype.getContext = function (...given) {
    return (window.context = own.apply(this, given));
  };
}"""
_WITHOUT_FLOATS = """
const own = WebGL2RenderingContext.prototype.getExtension;
WebGL2RenderingContext.prototype.getExtension = function (name) {
  return name === "EXT_color_buffer_float" ? null : own.call(this, name);
};
"""


pytestmark = pytest.mark.usefixtures("chromium")


@pytest.fixture(scope="module")
def page_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("print")
    (folder / "part.py").write_text(PART)
    seen = viewable(distal.load(folder / "part.py"))
    options = PageOptions(printable=True, unit="cm", poster=False, views=["color"])
    made = write(seen, folder / "part.html", options)
    assert [text.split(" (")[0] for text in made.unprinted] == ["'Plane'"]
    return folder / "part.html"


def opened(path: Path) -> Any:
    return offline_page(path, flags=SWIFTSHADER, viewport={"width": 900, "height": 700})


def ready(watched: Watched) -> Any:
    page = watched.page
    page.wait_for_function("() => document.querySelector('[data-distal]')?.distal")
    page.evaluate(_WATCH)
    page.locator("#print").select_option(str(CELLS))
    return page


def saved(page: Any, kind: str, folder: Path, limit_ms: int = 60_000) -> Path:
    """Save the part and return the file."""
    before = page.evaluate("window.saved.length")
    page.get_by_role("button", name=f"Save {kind}").click()
    page.wait_for_function("(n) => window.saved.length > n", arg=before, timeout=limit_ms)
    target = folder / f"part.{kind.lower()}"
    target.write_bytes(base64.b64decode(page.evaluate(_BYTES, before)))
    return target


def volume(points: np.ndarray, triangles: np.ndarray) -> float:
    a, b, c = (points[triangles[:, i]] for i in range(3))
    return float((a * np.cross(b, c)).sum() / 6.0)


def of_python(file: Path, tolerance: float | None = None, **params: float) -> Extracted:
    """Python's mesh of the part beside a page, at the page's spacing and tolerance."""
    seen = viewable(distal.load(file.with_name("part.py")))
    return meshed_at(seen, CELLS, tolerance, params)


def meshed_at(
    seen: Viewable,
    cells: int,
    tolerance: float | None = None,
    params: Mapping[str, float] | None = None,
) -> Extracted:
    """Python's mesh with so many equal cells along the largest side."""
    node, _ = printed_node(seen, PageOptions(printable=True))
    extent = extent_of(node, MeshRequest(params=params or {}))
    kernels = FieldKernels(node, params or {}, 0.0)
    wanted = tolerance or 2e-3 * extent.size
    step = extent.size / cells
    found = extracted(kernels, extent, step, wanted, 1_000_000, lambda _: None)
    assert isinstance(found, Extracted)
    return found


def compared(points: np.ndarray, triangles: np.ndarray, expected: Extracted) -> tuple[float, int]:
    """Check that the page has Python's points and as many triangles.

    ``points`` are in scene units, z up. Returns how far the worst point is from Python's, in cells,
    and how many triangles join other points.
    """
    known, faces = expected.made.points, expected.made.triangles
    assert (len(points), len(triangles)) == (len(known), len(faces))
    ours = np.stack([points[:, 0], points[:, 2], -points[:, 1]], axis=1)
    ours += (known.min(axis=0) + known.max(axis=0) - ours.min(axis=0) - ours.max(axis=0)) / 2.0
    misses, of_known = cKDTree(ours).query(known)
    assert len(np.unique(of_known)) == len(known)
    return float(misses.max() / expected.step), len(turned(of_known[faces]) - turned(triangles))


def turned(triangles: np.ndarray) -> set[tuple[int, ...]]:
    """The triangles as a set, each from its lowest number."""
    first = np.argmin(triangles, axis=1)[:, None]
    rows = np.take_along_axis(triangles, (first + np.arange(3)) % 3, axis=1)
    return set(map(tuple, rows.tolist()))


def test_a_part_is_saved_closed_and_like_python_s(page_file: Path, tmp_path: Path) -> None:
    with opened(page_file) as watched:
        page = ready(watched)
        three_mf, stl = (saved(page, kind, tmp_path) for kind in ("3MF", "STL"))
        words = page.locator("[aria-label=Print] [role=status]").text_content()
        frames = page.evaluate("window.frames")
        page.evaluate("document.querySelector('[data-distal]').distal.setParameter('bore', 0.3)")
        (tmp_path / "wider").mkdir()
        wider = saved(page, "STL", tmp_path / "wider")
        assert watched.complaints == [] and watched.requests == []
    assert frames > 5
    archive = zipfile.ZipFile(io.BytesIO(three_mf.read_bytes()))
    assert archive.testzip() is None
    text = archive.read("3D/3dmodel.model").decode()
    # The most frequent color first: it is that of the whole part.
    assert re.findall(r'color="(#\w+)"', text) == ["#3060A0FF", "#D07030FF"]
    mesh = read_mesh(three_mf)
    points, triangles = np.asarray(mesh.points), np.asarray(mesh.triangles)
    assert not any(checked(points, triangles).values())
    assert points[:, 2].min() == 0.0
    expected = of_python(page_file)
    # The page's unit is the centimeter; the foot closes the bore below.
    worst, others = compared(points / 10.0, triangles, expected)
    assert len(points) - len(triangles) // 2 == 2
    # Measured: .0024 for the worst point, along a crease, and 10 triangles in 51,988.
    assert worst < 1e-2 and others <= 40
    assert volume(points, triangles) == pytest.approx(
        1000.0 * volume(expected.made.points, expected.made.triangles), rel=1e-4
    )
    assert words.startswith(f"{len(triangles):,} triangles, 13 ")
    error, tolerance = 10.0 * expected.error, 0.02 * 1.3
    assert words.endswith(
        f"up to {error:.2g} mm from the surface, measured. "
        f"256 cells should keep {tolerance:.2g} mm."
    )
    plain = read_mesh(stl)
    assert len(plain.triangles) == len(triangles)
    less = of_python(page_file, bore=0.3)
    second = read_mesh(wider)
    assert volume(np.asarray(second.points), np.asarray(second.triangles)) == pytest.approx(
        1000.0 * volume(less.made.points, less.made.triangles), rel=1e-4
    )


def test_creases_leave_their_cells_as_in_python(tmp_path: Path) -> None:
    # Edges in space: 21 cells may reach into empty ones, and 8 points do.
    (tmp_path / "part.py").write_text(
        "from distal import Box\npart = Box(1.0, 0.7, 0.4).rotate(x=0.3, z=0.4)\n"
    )
    seen = viewable(distal.load(tmp_path / "part.py"))
    options = PageOptions(printable=True, poster=False, views=["color"], tolerance=1e-4)
    write(seen, tmp_path / "part.html", options)
    expected = of_python(tmp_path / "part.html", tolerance=1e-4)
    with opened(tmp_path / "part.html") as watched:
        page = ready(watched)
        mesh = read_mesh(saved(page, "3MF", tmp_path))
        words = page.locator("[aria-label=Print] [role=status]").text_content()
        assert watched.complaints == []
    points, triangles = np.asarray(mesh.points), np.asarray(mesh.triangles)
    assert not any(checked(points, triangles).values())
    worst, others = compared(points, triangles, expected)
    assert worst < 1e-3 and others == 0
    cell = expected.topology.points.cell
    home = (expected.made.points[: len(cell)] - expected.lattice.origin) / expected.step
    assert (np.floor(home) != cell).any(axis=1).sum() == 8
    assert f"up to {expected.error:.2g}" in words
    assert words.endswith("measured. distal mesh should keep 0.00010 mm.")


def test_thin_parts_are_named_and_the_picture_is_drawn_again(tmp_path: Path) -> None:
    # The plate lies between two planes of the lattice.
    plate = Box(1.0, 0.004, 1.0).translate(0.0, -0.15 + 29.13 / 64.0, 0.0)
    shape = Box(1.0, 0.3, 1.0) | plate
    options = PageOptions(printable=True, poster=False, views=["color"])
    write(viewable(shape), tmp_path / "thin.html", options)
    with opened(tmp_path / "thin.html") as watched:
        page = ready(watched)
        page.evaluate(_REST)
        points = np.asarray(read_mesh(saved(page, "STL", tmp_path)).points)
        assert np.ptp(points, axis=0) == pytest.approx([1.0, 1.0, 0.3], abs=1e-5)
        words = page.locator("[aria-label=Print] [role=status]").text_content()
        assert words.endswith("Parts thinner than a cell are missing.")
        # The time of the picture that the panel shows is not one that was measured while saving.
        page.wait_for_function("() => window.drawn > 0")


def test_a_context_that_is_lost_is_named_and_the_next_save_works(
    page_file: Path, tmp_path: Path
) -> None:
    phone = {"width": 390, "height": 844}
    with offline_page(page_file, flags=SWIFTSHADER, viewport=phone) as watched:
        page = watched.page
        page.wait_for_function("() => document.querySelector('[data-distal]')?.distal")
        page.evaluate("document.querySelector('[data-distal]').distal.togglePanel()")
        ready(watched)
        page.evaluate(_KEEP_CONTEXT)
        status = page.locator("[aria-label=Print] [role=status]").element_handle()
        page.get_by_role("button", name="Save STL").click()
        page.evaluate("window.context.getExtension('WEBGL_lose_context').loseContext()")
        page.wait_for_function(
            "([e, text]) => e.textContent === text", arg=[status, "The graphics driver stopped."]
        )
        first, second = (saved(page, "STL", tmp_path).read_bytes() for _ in range(2))
        assert first == second and len(first) > 1e6
        box = page.get_by_role("button", name="Save STL").bounding_box()
        assert box["x"] >= 0 and box["x"] + box["width"] <= phone["width"]
        assert watched.requests == []


def test_the_worst_fields_do_not_intersect(tmp_path: Path) -> None:
    # Noise as fine as the cells, values without a slope, and edges and faces that only touch.
    fields = noise("linear", 3, 0.06, 40.0) | noise("cubes", 2, 0.06, 40.0).translate(0.9, 0.0, 0.0)
    boxes = Box(0.4) | Box(0.4).translate(0.4, 0.4, 0.0)
    # Here a unit in the last place is 1/800 of a cell.
    shape = (fields | boxes.translate(2.6, 0.0, 0.0)).translate(500.0, 70.0, 0.0)
    options = PageOptions(printable=True, poster=False, views=["color"])
    write(viewable(shape), tmp_path / "hard.html", options)
    with opened(tmp_path / "hard.html") as watched:
        mesh = read_mesh(saved(ready(watched), "STL", tmp_path))
        assert watched.complaints == []
    points, triangles = np.asarray(mesh.points), np.asarray(mesh.triangles)
    assert len(triangles) > 10_000
    assert not any(checked(points, triangles).values())


def test_a_page_says_why_it_cannot_save(tmp_path: Path) -> None:
    (tmp_path / "plate.py").write_text(
        "from distal import Box\nfrom distal.lang import slider\n"
        'away, thick = slider("Away", 0.0, 0.0, 20000.0), slider("Thick", 0.1, 0.001, 0.2)\n'
        "plate = Box(1.0, thick, 1.0).translate(away, 0.0, 0.0)\n"
    )
    options = PageOptions(printable=True, poster=False, views=["color"])
    write(viewable(distal.load(tmp_path / "plate.py")), tmp_path / "plate.html", options)
    with opened(tmp_path / "plate.html") as watched:
        page = ready(watched)
        status = page.locator("[aria-label=Print] [role=status]").element_handle()
        for away, thick, reason in (
            (20_000.0, 0.1, "Too far from the origin for so small cells."),
            (0.0, 0.001, "Nothing is as thick as a cell, 0.016 mm."),
        ):
            page.evaluate(_SET, {"away": away, "thick": thick})
            page.get_by_role("button", name="Save STL").click()
            page.wait_for_function("([e, t]) => e.textContent === t", arg=[status, reason])
        assert page.evaluate("window.saved.length") == 0
        page.evaluate(_SET, {"away": 0.0, "thick": 0.1})
        points = np.asarray(read_mesh(saved(page, "STL", tmp_path)).points)
        assert np.ptp(points, axis=0) == pytest.approx([1.0, 1.0, 0.1], abs=1e-5)
        assert watched.complaints == []


def test_a_save_can_be_cancelled_and_begun_again(page_file: Path, tmp_path: Path) -> None:
    with opened(page_file) as watched:
        page = ready(watched)
        page.get_by_role("button", name="Save 3MF").click()
        page.get_by_role("button", name="Cancel").click()
        status = page.locator("[aria-label=Print] [role=status]")
        page.wait_for_function("(e) => e.textContent === 'Cancelled'", arg=status.element_handle())
        assert page.get_by_role("button", name="Save 3MF").is_visible()
        assert page.evaluate("window.saved.length") == 0
        assert len(read_mesh(saved(page, "STL", tmp_path)).triangles) == 51_988


def test_a_browser_without_float_targets_says_so(page_file: Path, tmp_path: Path) -> None:
    blind = tmp_path / "blind.html"
    text = page_file.read_text()
    text = re.sub(r'<meta http-equiv="Content-Security-Policy"[^>]*>', "", text)
    blind.write_text(text.replace("<title>", f"<script>{_WITHOUT_FLOATS}</script><title>"))
    with opened(blind) as watched:
        group = watched.page.locator("[aria-label=Print]")
        group.wait_for()
        assert "draw no floats (EXT_color_buffer_float)" in group.text_content()
        assert group.get_by_role("button").count() == 0


def test_tables_fit_what_the_page_reads() -> None:
    lengths, packed = packed_tables()
    assert len(lengths) == 13 and len(packed) < 8_000


@pytest.mark.parametrize(
    ("scene", "flags", "message"),
    [
        ("part.py", ["--printable", "--unit", "ell"], "a unit is one of um, mm, cm, m, inch, ft"),
        ("part.py", ["--printable", "--no-panel"], "which --no-panel leaves out"),
        ("part.py", ["--unit", "mm"], "--unit is for --printable"),
        ("part.py", ["--tolerance", "1"], "--tolerance is for --printable"),
        (
            "part.py",
            ["--printable", "--tolerance", "-1"],
            "--tolerance is a length above 0, not -1",
        ),
        ("flat.py", ["--printable"], "is a flat shape: .extrude(height) makes a solid"),
        ("endless.py", ["--printable"], "nothing of 'Plane' has an end"),
    ],
)
def test_what_cannot_be_printed_is_refused(
    tmp_path: Path, scene: str, flags: list[str], message: str
) -> None:
    (tmp_path / "part.py").write_text(PART)
    (tmp_path / "flat.py").write_text("from distal import Circle\nflat = Circle(1.0)\n")
    (tmp_path / "endless.py").write_text("from distal import Plane\nfloor = Plane(y=0.0)\n")
    target = tmp_path / "out.html"
    done = CliRunner().invoke(
        application, ["export", str(tmp_path / scene), "-o", str(target), *flags]
    )
    assert done.exit_code != 0 and message in " ".join(done.output.split())
    assert not target.exists()
