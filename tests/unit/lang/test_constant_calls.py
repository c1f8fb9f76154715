"""Built-ins of plain values, called where a scene's module computes its constants."""

from __future__ import annotations

import subprocess
import sys

import pytest

from distal.lang import cross, dot, length, mat2, max, mix, normalize, sin, transpose, vec2, vec3

WITHOUT_PACKAGES = """
import sys

class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in ("numpy", "llvmlite", "wgpu", "PIL"):
            raise ImportError(name)

sys.meta_path.insert(0, Blocked())
from distal.lang import normalize, vec3
print(normalize(vec3(3, 0, 4)) * 5.0)
"""


def test_values() -> None:
    assert list(normalize(vec3(3, 0, 4))) == pytest.approx([0.6, 0.0, 0.8], abs=1e-15)
    assert repr(max(vec3(1, 2, 3), 2)) == "vec3(2.0, 2.0, 3.0)"
    assert sin(1) == pytest.approx(0.8414709848078965, abs=1e-15)
    assert length(vec2(3, 4)) == 5.0
    assert dot(vec2(1, 2), vec2(3, 4)) == 11.0
    assert repr(cross(vec3(1, 0, 0), vec3(0, 1, 0))) == "vec3(0.0, 0.0, 1.0)"
    assert mix(0, 1, 0.25) == 0.25


def test_what_is_not_known_here_is_left_to_a_device() -> None:
    assert repr(transpose(mat2(1, 2, 3, 4))) == "mat2(vec2(1.0, 3.0), vec2(2.0, 4.0))"
    with pytest.raises(TypeError, match=r"length\(\) does not take"):
        length(2.0)  # type: ignore[call-overload]


def test_no_package_is_needed() -> None:
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT_PACKAGES], capture_output=True, text=True, timeout=60
    )
    assert done.stdout.strip() == "vec3(3.0, 0.0, 4.0)", done.stderr
