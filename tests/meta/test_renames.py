"""The tool that rewrites calls with former names."""

from __future__ import annotations

import pytest

from tools.renames import FORMER_ORDERS, rewritten, rewritten_document

CALLS = {
    "Pie(1.0, 0.7)": "Pie(1.0, opening=1.4)",
    "Pie(1, angle=math.pi / 3)": "Pie(1, opening=2 * math.pi / 3)",
    "Pie(angle=pi / 2)": "Pie(opening=pi)",
    "Pie(angle=0.5 * a)": "Pie(opening=a)",
    "Ring(1, angle=x + y, thickness=0.3)": "Ring(1, thickness=0.3, opening=2 * (x + y))",
    "Arc(0.75, 1.6, 0.2)": "Arc(0.75, thickness=0.2, opening=3.2)",
    "distal.CappedTorus(2.0, 0.75, 0.25)": "distal.CappedTorus(0.75, 0.25, opening=4.0)",
    "Link(0.5, 0.4, 0.15)": "Link(0.4, 0.15, length=0.5)",
    "Prism(6, 0.6, 2.4)": "Prism(0.6, 2.4, count=6)",
    "Prism(7)": "Prism(count=7)",
    "VesicaSolid(1.5, 0.75)": "VesicaSolid(0.75, height=1.5)",
    "Wedge(1.0)": "Wedge(opening=1.0)",
    'Nut("M6", clearance=gap)': 'Nut("M6", gap=gap)',
    'Text("a", align="centre")': 'Text("a", justify="center")',
    'ball.shell(0.1, "centre")': 'ball.shell(0.1, "center")',
    "from distal import metre": "from distal import meter",
    "class Ring: ...\nRing(0.4, 0.2)": "class Ring: ...\nRing(0.4, 0.2)",
    "Camera.yaw_pitch_roll(p, mirror=True)": "Camera.yaw_pitch_roll(p, mirrored=True)",
    'a.apply("xor cubic", others=[b], k=0.1)': 'a.apply("xor cubic", others=[b], smooth=0.1)',
    "from distal import gradient\ngradient(a, b)": (
        "from distal import linear_gradient\nlinear_gradient(a, b)"
    ),
    "from distal.lang import gradient\ngradient(f, p)": (
        "from distal.lang import gradient\ngradient(f, p)"
    ),
    "Cylinder(0.4, height=0.2)": "Cylinder(0.4, height=0.2)",
}


@pytest.mark.parametrize("code", CALLS)
def test_a_call_is_rewritten_once(code):
    assert rewritten(code) == CALLS[code]
    assert rewritten(CALLS[code]) == CALLS[code]


def test_python_in_documents_is_rewritten():
    text = 'Take `Nut("M6", clearance=0.1)`:\n```python\nwedge = Wedge(1.0)\n```\nWedge(1.0)\n'
    expected = (
        'Take `Nut("M6", gap=0.1)`:\n```python\nwedge = Wedge(opening=1.0)\n```\nWedge(1.0)\n'
    )
    assert rewritten_document(text) == expected


def test_every_order_is_rewritten():
    for name, order in FORMER_ORDERS.items():
        code = f"{name}({', '.join(f'n{i}' for i in range(len(order)))})"
        assert "=" in rewritten(code)
        assert rewritten(rewritten(code)) == rewritten(code)
