"""Threads of a nervous interpreter compile and render scenes: ``nervous NAME ...``.

Prints a row for each scene: its name and the digests of its texts and its picture. With ``alone``
one scene is made after the other. Cold caches, so that all threads do all the work at once.
"""

from __future__ import annotations

import hashlib
import json
import sys
import threading
import traceback
from collections.abc import Callable

import distal
from distal import Box, Capsule, Cone, Gyroid, Material, Plane, Scene, Sphere, Torus
from distal.lang import func, length, slider, struct, vec3


@struct
class Ring:
    """A struct that threads meet for the first time at once."""

    radius: float
    height: float


@func
def ring(p: vec3, r: Ring) -> float:
    """The distance from a sphere that is moved up."""
    return length(p - vec3(0.0, r.height, 0.0)) - r.radius


@func
def two_rings(p: vec3) -> float:
    """Two of them."""
    return min(ring(p, Ring(0.4, 0.2)), ring(p, Ring(0.5, -0.3)))


SCENES: dict[str, Callable[[], Scene]] = {
    "ball": lambda: Scene(Sphere(1.3)),
    "cone": lambda: Scene(Cone(0.5, 1.0) | Plane(y=-1)),
    "cut": lambda: Scene(Torus(1.0, 0.2) - Box(1.0)),
    "gyroid": lambda: Scene(Gyroid(1.0) & Sphere(1.0)),
    "twist": lambda: Scene(Box(1).twist(0.3)),
    "mirror": lambda: Scene(
        Capsule(0.3, 1).paint(Material(diffuse=0.5, specular=0.5)) | Sphere(0.2)
    ),
    "rings": lambda: Scene(distal.Shape.from_function(two_rings, bounds=((-1,) * 3, (1,) * 3))),
    "knob": lambda: Scene(
        Sphere(slider("Size", 0.5, low=0.1, high=1.0)).union(Box(0.4), smooth=0.1)
    ),
}


def row(name: str) -> list[str]:
    """Return the name, and the digests of the texts and the picture."""
    scene = SCENES[name]()
    texts = [distal.compile(scene, target=t).text for t in ("glsl-es300", "wgsl")]
    picture = scene.render(size=(16, 12), device="cpu", samples=1).array.tobytes()
    return [name, *(hashlib.sha256(x).hexdigest() for x in (*(t.encode() for t in texts), picture))]


def main(is_nervous: bool, names: list[str]) -> None:
    """Print the rows, and how each fault ended; all threads at once, or one after the other."""
    rows: list[list[str]] = []
    faults: list[str] = []
    start = threading.Barrier(len(names) if is_nervous else 1)

    def work(name: str) -> None:
        start.wait()
        try:
            rows.append(row(name))
        except BaseException:
            faults.append(traceback.format_exc())

    threads = [threading.Thread(target=work, args=(name,)) for name in names]
    if is_nervous:
        sys.setswitchinterval(1e-5)
    for thread in threads:
        thread.start()
        if not is_nervous:
            thread.join()
    for thread in threads:
        thread.join()
    print(json.dumps({"rows": rows, "faults": faults}))


if __name__ == "__main__":
    main(sys.argv[1] == "nervous", sys.argv[2:])
