"""What ``render`` hands to a frame, on both devices."""

from __future__ import annotations

import pytest

from distal.lang import Frame, image, vec4
from distal.runtime.executor import PythonExecutor


@image
def told(frame: Frame) -> vec4:
    return vec4(frame.mouse.xy, float(frame.index), float(frame.seed))


@pytest.mark.parametrize("device", ["cpu", "reference"])
def test_mouse_index_and_seed_arrive(device):
    picture = told.render(size=(2, 1), device=device, mouse=(1, 2, 3, 4), index=-7, seed=9)
    assert picture.array.tolist() == [[[1.0, 2.0, -7.0, 9.0]] * 2]


def test_whole_numbers_wrap_at_32_bits():
    picture = told.render(size=(1, 1), index=2**32 + 5, seed=-(2**32) + 6)
    assert picture.array[0, 0, 2:].tolist() == [5.0, 6.0]


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"mouse": 1}, ValueError, "mouse is four finite numbers, not 1"),
        ({"mouse": (1, 2, 3, float("nan"))}, ValueError, "mouse is four finite numbers"),
        ({"index": 1.5}, TypeError, r"index is a whole number, not 1\.5"),
        ({"time": float("inf")}, ValueError, "time is finite, not inf"),
        ({"size": (0, 4)}, ValueError, "each side has 1 to 16384 pixels, not 0x4"),
        ({"size": 4}, TypeError, r"size is \(width, height\) in pixels, not 4"),
        (
            {"device": "abacus"},
            ValueError,
            "there is no device 'abacus'; devices: auto, cpu, gpu, gpu-fragment, reference",
        ),
        ({"params": {"radius": 1}}, ValueError, "there is no parameter 'radius'; parameters: none"),
    ],
)
def test_mistakes_are_named(options, error, message):
    with pytest.raises(error, match=message):
        told.render(**{"size": (2, 2), **options})


def test_kernels_of_long_ago_are_dropped(monkeypatch):
    monkeypatch.setattr("distal.runtime.kernels.KERNELS_KEPT", 2)
    executor = PythonExecutor()

    def plain(shade):
        @image
        def picture(frame: Frame) -> vec4:
            return vec4(shade)

        return picture

    for shade in (0.1, 0.2, 0.3):
        lowered = executor.lower(plain(shade), None)
        executor.kernels.kernel(lowered, "reference", 32)
    assert len(executor.kernels) == 2
    assert (lowered.digest, "reference", 32) in {key[:3] for key in executor.kernels._kernels}
