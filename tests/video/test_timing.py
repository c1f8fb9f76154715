"""How frames lie in time: exact counts and times, rates as people write them."""

from fractions import Fraction

import pytest

from distal.video.formats import VideoError
from distal.video.timing import frame_rate, timing


@pytest.mark.parametrize(
    ("duration", "rate", "count"),
    [
        (10, 60, 600),
        (0.1, 30, 3),
        (0.05, 30, 2),  # 1.5 frames: the nearest, upwards
        (0.001, 30, 1),  # at least one
        ("1/3", 30, 10),
        (10, "29.97", 300),
        (1001, "30000/1001", 30000),
        (0.7, 10, 7),  # binary 0.7 * 10 is below 7
    ],
)
def test_count(duration, rate, count):
    assert timing(0, duration, rate).count == count


def test_times_do_not_drift():
    when = timing(2.5, 3600, "30000/1001")
    assert when.time(0) == 2.5
    assert when.time(30000) == 2.5 + 1001.0
    assert when.time(90000) == 2.5 + 3003.0


def test_the_last_frame_of_a_period_is_one_step_before_its_first():
    when = timing(0, 2, 24)
    assert when.time(when.count - 1) + 1 / 24 == pytest.approx(2.0)


def test_pieces_hold_two_seconds_and_each_frame_once():
    pieces = timing(0, 5, "30000/1001").pieces
    assert [len(piece) for piece in pieces] == [60, 60, 30]
    assert [i for piece in pieces for i in piece] == list(range(150))
    assert timing(0, 10, "0.1").pieces == [range(0, 1)]


def test_rates_of_broadcast_are_recognised():
    for written in (29.97, "29.97", "30000/1001", Fraction(30000, 1001)):
        assert frame_rate(written) == Fraction(30000, 1001)
    assert frame_rate(23.976) == Fraction(24000, 1001)
    assert frame_rate(59.94) == Fraction(60000, 1001)
    assert frame_rate(12.5) == Fraction(25, 2)
    assert frame_rate(30.0) == 30


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ((0, 0, 30), "a duration is more than 0 seconds, not 0"),
        ((0, -1, 30), "a duration is more than 0 seconds, not -1"),
        ((0, "nan", 30), "a duration is a number of seconds, not nan"),
        ((0, "1/0", 30), "a duration is a number of seconds, not 1/0"),
        (("soon", 1, 30), "a start is a number of seconds, not soon"),
        ((0, 1, 0), "a frame rate is more than 0 a second, not 0"),
        ((0, 1, -24), "a frame rate is more than 0 a second, not -24"),
        ((0, 1, "fast"), "a frame rate is a number like 30, 29.97 or 30000/1001, not fast"),
        ((0, 1, 1001), "a frame rate is at most 1000 a second, not 1001"),
        ((0, 1, "1e-9"), "a frame rate is at least 0.001 a second, not 1e-9"),
        (
            (0, 1, "1e-999999999"),
            "a frame rate is a number like 30, 29.97 or 30000/1001, not 1e-999999999",
        ),
        ((0, "1e999999999", 30), "a duration is a number of seconds, not 1e999999999"),
        (
            (0, 1e6, 60),
            "60000000 frames are too many: 1e+06 s at 60 fps; a sequence has at most 1000000",
        ),
    ],
)
def test_what_has_no_sense_is_refused(given, message):
    with pytest.raises(VideoError) as caught:
        timing(*given)
    assert str(caught.value) == message


@pytest.mark.parametrize(
    ("start", "duration"), [(1048577, 1), (-1048577, 1), (1048570, 10), ("1e8", "0.1")]
)
def test_times_stay_where_frames_are_told_apart(start: object, duration: object) -> None:
    with pytest.raises(VideoError, match=r"times are within 1048576 seconds \(12 days\) of 0"):
        timing(start, duration, 30)
    assert timing(1048570, 6, 30).time(0) == 1048570.0
