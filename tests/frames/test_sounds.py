"""Sound files that pictures read: closed forms, every target alike, and videos that are heard."""

from __future__ import annotations

import math
import re
import struct
import wave
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import distal
from distal.devices.base import DeviceError
from distal.diagnostics import LoadError
from distal.lang import Frame, SoundFile, image, ivec2, texel, vec3
from distal.lang.render_options import RenderOptions
from distal.scene.viewing.viewable import viewable
from distal.sounds.analysis import RATE, row_at, table, table_of
from distal.sounds.reading import Samples, read
from distal.video.soundtrack import cut, mixed

SAMPLES_A_SECOND = 44_100
TONE_HZ = 1000.0
SILENCE = 128


def tone(seconds: float, hertz: float = TONE_HZ, loudness: float = 0.5) -> NDArray[np.float32]:
    times = np.arange(round(seconds * SAMPLES_A_SECOND)) / SAMPLES_A_SECOND
    return (loudness * np.sin(2.0 * np.pi * hertz * times)).astype(np.float32)


def written(file: Path, channels: Any, width: int = 2) -> Path:
    """A WAV file of these samples."""
    with wave.open(str(file), "wb") as out:
        out.setnchannels(len(channels))
        out.setsampwidth(width)
        out.setframerate(SAMPLES_A_SECOND)
        values = np.asarray(channels).T.reshape(-1)
        full = 2 ** (8 * width - 1)
        whole = np.clip(np.rint(values * full), -full, full - 1).astype(np.int64)
        if width == 1:
            whole += 128
        data = whole.astype("<i8").view(np.uint8).reshape(-1, 8)[:, :width]
        out.writeframes(data.tobytes())
    return file


@pytest.fixture(scope="module")
def song(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Half a second of a tone, then half a second of silence."""
    file = tmp_path_factory.mktemp("sounds") / "song.wav"
    return written(file, [np.concatenate([tone(0.5), 0.0 * tone(0.5)])])


def test_a_sound_of_the_examples_is_found_from_every_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert read(SoundFile("example:arpeggio.wav").path).seconds > 1.0
    with pytest.raises(LoadError, match=r"cannot read the sound example:none\.wav"):
        read(SoundFile("example:none.wav").path)


def bars_of(sound: SoundFile) -> Any:
    @image
    def bars(frame: Frame) -> vec3:
        column = int(frame.coord.x / frame.resolution.x * 64.0)
        wave = texel(sound, ivec2(column, 1)).x
        return vec3(texel(sound, ivec2(column, 0)).x, wave, 0.0)

    return bars


@pytest.mark.parametrize("width", [1, 2, 3, 4])
def test_samples_of_every_width_are_read(width: int, tmp_path: Path) -> None:
    left, right = tone(0.05), tone(0.05, 300.0)
    found = read(written(tmp_path / "a.wav", [left, right], width))
    assert found.rate == SAMPLES_A_SECOND
    assert np.abs(found.channels - [left, right]).max() <= 2.0 / 2 ** (8 * width - 1) + 1e-7


def test_a_tone_is_a_peak_at_its_frequency_and_height() -> None:
    rows = table(Samples(SAMPLES_A_SECOND, tone(1.0, loudness=0.05)[None]))
    assert rows.shape == (RATE, 2, 512)
    spectrum = rows[-1, 0].astype(int)
    bin_hz = SAMPLES_A_SECOND / 2048
    assert abs(int(spectrum.argmax()) - TONE_HZ / bin_hz) <= 1.0
    # The window's sum is 0.42 of its length, and half of a sine is in positive frequencies.
    # Between two bins a Blackman window loses 1.1 dB at most. 255 bytes are 70 dB.
    level = 20.0 * math.log10(0.05 / 2.0 * 0.42)
    highest = 255.0 * (level + 100.0) / 70.0
    assert highest - 255.0 * 1.1 / 70.0 - 1.0 <= spectrum.max() <= highest
    assert spectrum[200:].max() < 60  # -84 dB, where there is no tone


def test_smoothing_is_that_of_web_audio() -> None:
    quiet = tone(1.0, loudness=1e-3)
    rows = table(Samples(SAMPLES_A_SECOND, np.concatenate([quiet, 0.0 * quiet])[None]))
    at = int(rows[RATE, 0].argmax())
    # After the block has run empty, each row is 0.8 of the one before: 1.94 dB, 7.06 bytes.
    falling = rows[RATE + 4 : RATE + 12, 0, at].astype(float)
    assert np.abs(np.diff(falling) - 255.0 * 20.0 * math.log10(0.8) / 70.0).max() <= 1.0


def test_the_wave_is_the_samples() -> None:
    samples = tone(1.0)
    rows = table(Samples(SAMPLES_A_SECOND, samples[None]))
    last = round(59 * SAMPLES_A_SECOND / RATE)
    block = samples[last - 2048 : last - 2048 + 512]
    assert np.array_equal(rows[59, 1], np.floor(128.0 * (1.0 + block)).astype(np.uint8))
    assert set(rows[0, 1]) == {SILENCE}


def test_rows_of_times() -> None:
    assert [row_at(t, 60, loop=True) for t in (0.0, 0.5, 1.0, 1.5, -0.5)] == [0, 30, 0, 30, None]
    assert [row_at(t, 60, loop=False) for t in (0.0, 0.99, 1.0)] == [0, 59, None]


def test_a_picture_hears_the_time_of_its_frame(song: Path) -> None:
    bars, sound = bars_of(SoundFile(song)), table_of(SoundFile(song))
    for time in (0.0, 0.25, 0.75, 1.25):
        shown = bars.render(size=(64, 2), time=time).array
        row = sound[round(time * RATE) % RATE] / 255.0
        assert np.abs(shown[0, :, 0] - row[0, :64]).max() < 1e-6
        assert np.abs(shown[0, :, 1] - row[1, :64]).max() < 1e-6
    once = bars_of(SoundFile(song, loop=False)).render(size=(64, 2), time=1.25).array
    assert float(once[..., 0].max()) == 0.0
    assert once[..., 1] == pytest.approx(SILENCE / 255.0, abs=1e-6)


@pytest.mark.parametrize("device", ["reference", "gpu"])
def test_other_devices_hear_the_same(song: Path, device: str) -> None:
    bars = bars_of(SoundFile(song))
    try:
        found = bars.render(size=(64, 2), time=0.25, device=device).array
    except DeviceError as missing:
        pytest.skip(f"nothing is heard on {device}: {missing}")
    assert np.abs(found - bars.render(size=(64, 2), time=0.25).array).max() < 1e-5


def test_it_moves_and_shadertoy_gets_its_channel(song: Path, tmp_path: Path) -> None:
    bars = bars_of(SoundFile(song))
    assert viewable(bars).animated
    bars.export(tmp_path / "bars.glsl", target="shadertoy")
    assert "// iChannel0: sound (Texture2D, clamp)" in (tmp_path / "bars.glsl").read_text()


@pytest.mark.parametrize("suffix", ["mp4", "webm"])
def test_a_video_plays_what_its_picture_hears(song: Path, suffix: str, tmp_path: Path) -> None:
    av: Any = pytest.importorskip("av", reason="PyAV is not installed")
    file = tmp_path / f"bars.{suffix}"
    made = bars_of(SoundFile(song))
    made.video(file, duration=3.0, fps=10, size=(64, 16), start=0.25)
    with av.open(str(file)) as film:
        (video,), (audio,) = film.streams.video, film.streams.audio
        assert len(list(film.decode(video))) == 30
        film.seek(0)
        parts = [frame.to_ndarray()[0] for frame in film.decode(audio)]
        rate = audio.rate
    heard = np.concatenate(parts)
    # A codec delays by less than 0.05 s, and fills up its last block.
    assert abs(len(heard) / rate - 3.0) < 0.05
    loud = [
        float(np.abs(heard[round(rate * (t - 0.05)) : round(rate * (t + 0.05))]).max())
        for t in (0.1, 0.5, 1.0, 1.5, 2.0, 2.5)
    ]
    # From 0.25 s on: a tone until 0.25 s, silence until 0.75 s, a tone until 1.25 s, ...
    assert [value > 0.3 for value in loud] == [True, False, True, False, True, False], loud
    again = tmp_path / f"again.{suffix}"
    made.video(again, duration=3.0, fps=10, size=(64, 16), start=0.25)
    assert file.read_bytes() == again.read_bytes()


def test_sounds_are_mixed() -> None:
    low, high = (Samples(48_000, tone(0.1, f, 0.4)[None]) for f in (300.0, 2000.0))
    both = mixed([low, high])
    assert np.abs(both.channels - (low.channels + high.channels)).max() < 1e-6
    loud = mixed([low, high, low])
    assert float(loud.channels.max()) == 1.0
    # Two channels and one: the one is on both sides; the longer one goes on alone.
    sides = Samples(48_000, np.stack([0.0 * tone(0.05), tone(0.05, 500.0)]))
    found = mixed([low, sides]).channels
    short = sides.channels.shape[1]
    assert np.array_equal(found[0, :short], low.channels[0, :short])
    assert np.abs(found[1, :short] - low.channels[0, :short] - sides.channels[1]).max() < 1e-6
    assert np.array_equal(found[:, short:], np.repeat(low.channels[:, short:], 2, axis=0))
    assert mixed([low]) is low


def test_a_video_plays_all_sounds_of_its_picture(song: Path, tmp_path: Path) -> None:
    av: Any = pytest.importorskip("av", reason="PyAV is not installed")
    late = written(tmp_path / "late.wav", [np.concatenate([0.0 * tone(0.5), tone(0.5, 300.0)])])
    first, second = SoundFile(song), SoundFile(late)

    @image
    def both(frame: Frame) -> vec3:
        at = ivec2(int(frame.coord.x), 1)
        return vec3(texel(first, at).x, texel(second, at).x, 0.0)

    file = tmp_path / "both.mp4"
    both.video(file, duration=2.0, fps=10, size=(64, 16))
    with av.open(str(file)) as film:
        audio = film.streams.audio[0]
        heard = np.concatenate([frame.to_ndarray()[0] for frame in film.decode(audio)])
        rate = audio.rate
    for t in (0.25, 0.75, 1.25, 1.75):
        part = heard[round(rate * (t - 0.05)) : round(rate * (t + 0.05))]
        assert float(np.abs(part).max()) > 0.3, t


def test_a_part_of_a_sound() -> None:
    samples = Samples(10, np.arange(10, dtype=np.float32)[None])
    looped = cut(samples, Fraction(1, 2), Fraction(1), loop=True).channels[0]
    assert looped.tolist() == [5, 6, 7, 8, 9, 0, 1, 2, 3, 4]
    once = cut(samples, Fraction(1, 2), Fraction(1), loop=False).channels[0]
    assert once.tolist() == [5, 6, 7, 8, 9, 0, 0, 0, 0, 0]


def test_a_song_of_another_format(tmp_path: Path) -> None:
    av: Any = pytest.importorskip("av", reason="PyAV is not installed")
    file = tmp_path / "song.m4a"
    with av.open(str(file), "w") as out:
        stream = out.add_stream("aac", rate=SAMPLES_A_SECOND)
        stream.layout = "mono"
        samples = tone(1.0, loudness=0.05)[None]
        frame = av.AudioFrame.from_ndarray(samples, format="fltp", layout="mono")
        frame.sample_rate = SAMPLES_A_SECOND
        out.mux(stream.encode(frame))
        out.mux(stream.encode(None))
    found = read(file)
    assert (found.rate, len(found.channels)) == (SAMPLES_A_SECOND, 1)
    assert abs(found.seconds - 1.0) < 0.05
    spectrum = table(found)[40, 0]
    assert abs(int(spectrum.argmax()) - TONE_HZ / (SAMPLES_A_SECOND / 2048)) <= 1.0


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("gone.wav", None, "cannot read the sound gone.wav: No such file or directory"),
        ("empty.wav", b"", "cannot read the sound empty.wav: it is empty"),
        ("text.wav", b"no sound", "cannot read the sound text.wav: file does not start with RIFF"),
        ("text.mp3", b"no sound" * 99, "cannot read the sound text.mp3: Invalid data found when"),
    ],
)
def test_what_is_no_sound_is_one_line(
    name: str, content: bytes | None, message: str, tmp_path: Path
) -> None:
    if name.endswith("mp3"):
        pytest.importorskip("av", reason="PyAV is not installed")
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(LoadError, match=re.escape(message)) as caught:
        bars_of(SoundFile(tmp_path / name)).render(size=(2, 2))
    assert "\n" not in str(caught.value)


def with_format(path: Path, kind: int, samples: NDArray[Any]) -> Path:
    """Write a WAV file of one channel with samples of a format: 1 for PCM, 3 for floats."""
    size, data = samples.itemsize, samples.tobytes()
    head = struct.pack("<IHHIIHH", 16, kind, 1, 8000, 8000 * size, size, 8 * size)
    body = b"WAVEfmt " + head + b"data" + struct.pack("<I", len(data)) + data
    path.write_bytes(b"RIFF" + struct.pack("<I", len(body)) + body)
    return path


def test_samples_of_64_bits_are_refused(tmp_path: Path) -> None:
    file = with_format(tmp_path / "wide.wav", 1, np.zeros(99, np.int64))
    with pytest.raises(
        LoadError, match=r"wide\.wav: it has 64 bits a sample; 8, 16, 24 and 32 can"
    ):
        read(file)


def test_samples_may_be_floats(tmp_path: Path) -> None:
    pytest.importorskip("av", reason="PyAV is not installed")
    samples = np.linspace(-1.0, 1.0, 999, dtype=np.float32)
    found = read(with_format(tmp_path / "floats.wav", 3, samples))
    np.testing.assert_array_equal(found.channels, samples[None])


def test_a_sound_that_is_too_long_is_named(tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.setattr("distal.sounds.reading.MOST_SECONDS", 0.01)
    written(tmp_path / "long.wav", [tone(0.05)])
    with pytest.raises(LoadError, match=r"long\.wav: it is 0 s long; 0\.01 s at most"):
        read(tmp_path / "long.wav")


def test_what_is_no_path_is_refused() -> None:
    with pytest.raises(TypeError, match="a sound is the path of a file, not 7"):
        SoundFile(7)  # type: ignore[arg-type]


def test_a_sound_says_what_it_is(song: Path) -> None:
    assert repr(SoundFile(song)) == "<sound 'song.wav'>"


def test_frames_of_buffers_hear_their_own_time(song: Path, tmp_path: Path) -> None:
    (tmp_path / "kept.py").write_text(
        "from distal.lang import Frame, SoundFile, buffer, image, ivec2, texel, vec4\n"
        f"song = SoundFile({str(song)!r})\n"
        "@buffer\ndef loudest(frame: Frame) -> vec4:\n"
        "    return texel(loudest, ivec2(0, 0)) + texel(song, ivec2(46, 0)).x\n"
        "@image\ndef picture(frame: Frame) -> vec4:\n    return texel(loudest, ivec2(0, 0))\n"
    )
    shown = distal.load(str(tmp_path / "kept.py")).render(size=(2, 2), time=1.0).array
    rows = table_of(SoundFile(song))
    # Frame 60 is second 1, where the sound begins again: row 0.
    total = float(rows[:, 0, 46].sum() + rows[0, 0, 46]) / 255.0
    assert float(shown[0, 0, 0]) == pytest.approx(total, rel=1e-5)


def test_options_are_those_of_every_picture(song: Path) -> None:
    picture = viewable(bars_of(SoundFile(song))).render(RenderOptions(size=(64, 2), time=0.25))
    assert float(picture.array[..., 0].max()) > 0.8
