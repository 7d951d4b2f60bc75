"""Recordings: every format, any length, and what is wrong with bad ones."""

from __future__ import annotations

import os
import subprocess
import sys
import tracemalloc
from collections.abc import Callable
from pathlib import Path

import av
import numpy as np
import pytest
import soundfile
from hypothesis import given, settings
from hypothesis import strategies as st

from lipwright.audio import (
    LEVEL_FLOOR,
    Audio,
    AudioFile,
    level_db,
    open_audio,
    read_audio,
    write_wav,
    written_by,
)  # fmt: skip
from lipwright.errors import LipwrightError

RATE = 16000
SECONDS = 2.0


def tone(seconds: float = SECONDS, rate: int = RATE, pitch: float = 300.0) -> np.ndarray:
    """A tone that swells and fades twice a second, (N,)."""
    t = np.arange(round(seconds * rate)) / rate
    return (0.5 * np.sin(2 * np.pi * pitch * t) * np.sin(np.pi * 2 * t) ** 2).astype(np.float32)


def by_sndfile(path: Path, **options: object) -> None:
    soundfile.write(path, tone(), RATE, **options)


def by_av(path: Path, codec: str, rate: int, video: bool = False, **options: str) -> None:
    samples = tone(rate=rate)
    with av.open(str(path), "w", options=options) as container:
        sound = container.add_stream(codec, rate=rate, layout="mono")
        if video:
            picture = container.add_stream("mpeg4", rate=25)
            picture.width = picture.height = 32
            picture.pix_fmt = "yuv420p"
            for _ in range(50):
                frame = av.VideoFrame.from_ndarray(np.zeros((32, 32, 3), np.uint8), "rgb24")
                container.mux(picture.encode(frame))
            container.mux(picture.encode())
        for start in range(0, len(samples), 1024):
            block = (samples[None, start : start + 1024] * 32767).astype(np.int16)
            frame = av.AudioFrame.from_ndarray(block, "s16", "mono")
            frame.sample_rate, frame.pts = rate, start
            container.mux(sound.encode(frame))
        container.mux(sound.encode())


MAKERS: dict[str, Callable[[Path], None]] = {
    "pcm16.wav": by_sndfile,
    "u8.wav": lambda path: by_sndfile(path, subtype="PCM_U8"),
    "pcm24.wav": lambda path: by_sndfile(path, subtype="PCM_24"),
    "float.wav": lambda path: by_sndfile(path, subtype="FLOAT"),
    "double.wav": lambda path: by_sndfile(path, subtype="DOUBLE"),
    "adpcm.wav": lambda path: by_sndfile(path, subtype="IMA_ADPCM"),
    "rf64.wav": lambda path: by_sndfile(path, format="RF64"),
    "sound.aiff": by_sndfile,
    "sound.au": by_sndfile,
    "sound.caf": by_sndfile,
    "sound.flac": by_sndfile,
    "sound.mp3": by_sndfile,
    "vorbis.ogg": by_sndfile,
    "opus.ogg": lambda path: by_sndfile(path, format="OGG", subtype="OPUS"),
    "index-last.m4a": lambda path: by_av(path, "aac", 44100),
    "index-first.m4a": lambda path: by_av(path, "aac", 44100, movflags="faststart"),
    "fragments.mp4": lambda path: by_av(path, "aac", 44100, movflags="frag_keyframe+empty_moov"),
    "video.mp4": lambda path: by_av(path, "aac", 44100, video=True),
    "video.mov": lambda path: by_av(path, "aac", 48000, video=True, movflags="faststart"),
    "video.mkv": lambda path: by_av(path, "aac", 48000, video=True),
    "video.avi": lambda path: by_av(path, "pcm_s16le", 44100, video=True),
    "sound.webm": lambda path: by_av(path, "libopus", 48000),
    "sound.aac": lambda path: by_av(path, "aac", 44100),
}


@pytest.fixture(scope="module")
def recordings(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("recordings")
    for name, make in MAKERS.items():
        make(folder / name)
    return folder


def refusal(path: str | os.PathLike[str], rate: int | None = None) -> str:
    """The one line that tells why `path` is not read."""
    with pytest.raises(LipwrightError) as caught:
        open_audio(path, rate)
    message = str(caught.value)
    assert "\n" not in message
    return message


@pytest.mark.parametrize("name", MAKERS)
def test_every_format_gives_the_sound_in_time_and_level(recordings, name):
    audio = read_audio(recordings / name, RATE)
    assert audio.rate == RATE
    assert audio.duration == pytest.approx(SECONDS, abs=0.06)  # lossy formats pad
    # Half a second holds one swell: the loudest instants tell of a shift.
    level = level_db(audio, 0.005)
    reference = level_db(Audio(tone(), RATE), 0.005)
    count = min(len(level), len(reference))
    lags = np.arange(-12, 13)
    energy, wanted = 10 ** (level[:count] / 20), 10 ** (reference[:count] / 20)
    match = [np.corrcoef(np.roll(energy, lag)[20:-20], wanted[20:-20])[0, 1] for lag in lags]
    assert max(match) > 0.98
    # These cannot tell that the encoder put 23 ms in front.
    untold = ("sound.aac", "fragments.mp4")
    assert abs(lags[int(np.argmax(match))]) <= (6 if name in untold else 1)
    assert np.abs(audio.samples).max() == pytest.approx(0.5, abs=0.06)


@pytest.mark.parametrize("name", ["pcm16.wav", "sound.flac", "index-first.m4a", "sound.mp3"])
def test_the_content_counts_and_not_the_suffix(recordings, tmp_path, name):
    for disguise in ("sound.txt", "sound.raw", "sound", "sound.wav"):
        path = tmp_path / disguise
        path.write_bytes((recordings / name).read_bytes())
        assert read_audio(path).duration == pytest.approx(SECONDS, abs=0.06)


def test_a_wav_is_read_exactly(recordings):
    audio = read_audio(recordings / "float.wav")
    assert (audio.rate, len(audio)) == (RATE, len(tone()))
    np.testing.assert_array_equal(audio.samples, tone())


@pytest.mark.parametrize("rate", [8000, 11025, 22050, 44100, 48000, 96000])
def test_any_rate_is_resampled_without_a_shift(tmp_path, rate):
    path = tmp_path / "sound.wav"
    soundfile.write(path, tone(rate=rate), rate, subtype="FLOAT")
    audio = read_audio(path, RATE)
    assert len(audio) == pytest.approx(len(tone()), abs=1)
    count = min(len(audio), len(tone()))
    middle = slice(200, count - 200)
    np.testing.assert_allclose(audio.samples[middle], tone()[:count][middle], atol=2e-3)


@pytest.mark.parametrize("channels", [2, 3, 6])
def test_channels_are_averaged(tmp_path, channels):
    path = tmp_path / "sound.wav"
    scale = np.linspace(0.2, 0.8, channels)
    soundfile.write(path, tone()[:, None] * scale, RATE, subtype="FLOAT")
    np.testing.assert_allclose(read_audio(path).samples, tone() * 0.5, atol=1e-6)


def test_stereo_in_antiphase_gives_the_louder_side(tmp_path):
    path = tmp_path / "sound.wav"
    soundfile.write(path, np.stack([-0.99 * tone(), tone()], 1), RATE, subtype="FLOAT")
    np.testing.assert_allclose(read_audio(path).samples, tone(), atol=1e-6)


def test_pieces_are_those_of_the_whole(recordings):
    whole = read_audio(recordings / "sound.flac")
    with open_audio(recordings / "sound.flac") as file:
        assert (file.rate, len(file), file.duration) == (RATE, len(whole), whole.duration)
        assert file.name == str(recordings / "sound.flac")
        for sound in (whole, file):
            part = sound.read(0.25, 0.75)
            np.testing.assert_array_equal(part.samples, whole.samples[4000:12000])
            assert len(sound.read(-3, 99)) == len(whole)
            assert len(sound.read(5, 6)) == 0
            for seconds in (0.3, 0.7001, 10):
                blocks = [block.samples for block in sound.blocks(seconds)]
                np.testing.assert_array_equal(np.concatenate(blocks), whole.samples)
            with pytest.raises(ValueError, match=r"from 2 to 1 s"):
                sound.read(2, 1)


def test_a_closed_file_is_not_read(recordings):
    file = open_audio(recordings / "pcm16.wav")
    file.close()
    with pytest.raises(ValueError, match="closed"):
        file.read(0, 1)


@pytest.mark.parametrize(
    ("samples", "rate", "reason"),
    [
        (np.zeros((2, 2)), 16000, "shape"),
        (np.array([0, np.nan]), 16000, "sample 1 is not a finite number"),
        (np.zeros(2), 0, "rate"),
        (np.zeros(2), 0.5, "rate"),
    ],
)
def test_audio_that_cannot_be_is_refused(samples, rate, reason):
    with pytest.raises(ValueError, match=reason):
        Audio(samples, rate)


def test_audio_is_frozen():
    samples = np.zeros(4, np.float32)
    audio = Audio(samples, RATE)
    samples[0] = 1
    assert audio.samples[0] == 0
    with pytest.raises(ValueError, match="read-only"):
        audio.samples[0] = 1


@pytest.mark.parametrize("share", [0.5, 0.9])
@pytest.mark.parametrize("name", MAKERS)
def test_a_file_that_is_cut_off_is_an_error_that_tells_how_much_is_left(
    recordings, tmp_path, name, share
):
    path = tmp_path / name
    data = (recordings / name).read_bytes()
    path.write_bytes(data[: int(len(data) * share)])
    message = refusal(path)
    assert message.startswith(f"{path}: is ")
    assert "cut off" in message
    if "is not a sound file" not in message:  # too little is left to know what it was
        told = float(message.split("is cut off: ")[1].split(" s")[0])
        assert 0 <= told < SECONDS
        assert "export it again" in message


@pytest.mark.parametrize("size", [0, 0x7FFFFFFF, 0xFFFFFFFF])
def test_a_wav_that_was_written_to_a_pipe_promises_nothing(recordings, tmp_path, size):
    data = bytearray((recordings / "pcm16.wav").read_bytes())
    where = data.index(b"data") + 4
    if size:
        data[where : where + 4] = size.to_bytes(4, "little")
        data[4:8] = size.to_bytes(4, "little")
    path = tmp_path / "piped.wav"
    path.write_bytes(data)
    assert read_audio(path).duration == SECONDS


def test_a_missing_file_a_folder_and_an_empty_file_are_errors(tmp_path):
    assert "no such file" in refusal(tmp_path / "none.wav")
    assert "is a folder" in refusal(tmp_path)
    (tmp_path / "empty.wav").touch()
    assert "is empty" in refusal(tmp_path / "empty.wav")
    assert "cannot be read" in refusal("a\0b.wav")
    assert "cannot be read" in refusal("a" * 5000)


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="root may read everything")
def test_a_file_without_permission_is_an_error(recordings, tmp_path):
    path = tmp_path / "secret.wav"
    path.write_bytes((recordings / "pcm16.wav").read_bytes())
    path.chmod(0)
    assert "permissions" in refusal(path)


@pytest.mark.parametrize(
    "data",
    [b"hello\n" * 100, b"\x89PNG\r\n\x1a\n" + bytes(99), b"%PDF-1.7" + bytes(99), bytes(4096),
     b"#EXTM3U\n/etc/passwd\n", b"ffconcat version 1.0\nfile sound.wav\n"],
)  # fmt: skip
def test_what_is_not_sound_is_an_error(tmp_path, data):
    path = tmp_path / "sound.wav"
    path.write_bytes(data)
    assert "is not a sound file" in refusal(path)


def test_a_wav_without_samples_is_an_error(tmp_path):
    path = tmp_path / "none.wav"
    soundfile.write(path, np.zeros(0), RATE)
    assert "has no sound samples" in refusal(path)
    soundfile.write(path, np.zeros(1), 48000)
    assert "has no sound samples" in refusal(path, 16000)


def test_a_video_without_sound_is_an_error(tmp_path):
    path = tmp_path / "mute.mp4"
    with av.open(str(path), "w") as container:
        stream = container.add_stream("mpeg4", rate=25)
        stream.width = stream.height = 32
        stream.pix_fmt = "yuv420p"
        container.mux(stream.encode(av.VideoFrame(32, 32, "yuv420p")))
        container.mux(stream.encode())
    assert "has no sound" in refusal(path)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e30])
def test_a_sample_that_is_no_number_is_an_error_with_its_time(tmp_path, value):
    path = tmp_path / "bad.wav"
    samples = tone()
    samples[8000] = value
    soundfile.write(path, samples, RATE, subtype="FLOAT")
    assert "the sample at 0.500 s is " in refusal(path)


def test_a_rate_that_no_speech_has_is_an_error(tmp_path):
    path = tmp_path / "slow.wav"
    soundfile.write(path, tone(), 100)
    assert "a rate of 100 Hz" in refusal(path)


def test_silence_is_sound(tmp_path):
    path = tmp_path / "silence.wav"
    soundfile.write(path, np.zeros(RATE), RATE)
    audio = read_audio(path)
    assert (level_db(audio) == LEVEL_FLOOR).all()


@pytest.mark.parametrize("rate", [8000, 11025, 22050])
@pytest.mark.parametrize("step", [0.01, 0.0333, 0.02])
def test_levels_are_those_of_their_steps(tmp_path, rate, step):
    samples = np.random.default_rng(0).normal(0, 0.1, round(21.003 * rate)).astype(np.float32)
    levels = level_db(Audio(samples, rate), step)
    edges = np.round(np.arange(len(levels) + 1) * step * rate).astype(int)
    assert edges[-2] < len(samples) <= edges[-1]
    for index in (0, 1, 77, len(levels) - 2, len(levels) - 1):
        part = samples[edges[index] : edges[index + 1]].astype(np.float64)
        assert levels[index] == pytest.approx(10 * np.log10(np.mean(part**2)), abs=1e-3)


def test_written_wavs_are_read_back(recordings, tmp_path):
    path = tmp_path / "out.wav"
    with open_audio(recordings / "sound.mp3") as file:
        write_wav(path, file)
        wanted = file.read(0, file.duration).samples
    assert soundfile.info(path).subtype == "PCM_16"
    np.testing.assert_allclose(read_audio(path).samples, wanted, atol=1 / 32768)


def test_a_wav_that_cannot_be_written_is_an_error(tmp_path):
    with pytest.raises(LipwrightError, match="is a folder"):
        write_wav(tmp_path, Audio(tone(), RATE))
    with pytest.raises(LipwrightError, match="cannot be written"):
        write_wav(tmp_path / "none" / "out.wav", Audio(tone(), RATE))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="names of files are Unicode there")
def test_a_wav_may_have_a_name_that_is_not_utf8(tmp_path):
    path = tmp_path / os.fsdecode(b"h\xe5ll.wav")
    write_wav(path, Audio(tone(), RATE), software="test")
    assert written_by(path) == "test"


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such limit")
def test_a_full_disk_is_named(tmp_path):
    import resource

    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (5000, before[1]))
    try:
        with pytest.raises(LipwrightError, match="File too large"):
            write_wav(tmp_path / "out.wav", Audio(tone(), RATE))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert list(tmp_path.iterdir()) == []


AGAIN = [b"standard", b"input", b"2.0", b"8000", b"2.0"]  # the second time at another rate
READ = (
    "import sys; from lipwright.audio import open_audio\n"
    "with open_audio(sys.argv[1]) as file: print(file.name, round(file.duration, 1))\n"
    "if sys.argv[1] == '-':\n"
    "    with open_audio('-', 8000) as file: print(file.rate, round(file.duration, 1))"
)


@pytest.mark.parametrize("name", ["pcm16.wav", "opus.ogg", "index-last.m4a"])
def test_standard_input_may_be_a_pipe_or_a_file_and_be_opened_again(recordings, name):
    data = (recordings / name).read_bytes()
    command = [sys.executable, "-c", READ, "-"]
    run = subprocess.run(command, input=data, capture_output=True, check=True)
    assert run.stdout.split() == AGAIN
    with (recordings / name).open("rb") as file:
        run = subprocess.run(command, stdin=file, capture_output=True, check=True)
    assert run.stdout.split() == AGAIN


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_a_named_pipe_is_read(recordings, tmp_path):
    path = tmp_path / "pipe"
    os.mkfifo(path)
    command = [sys.executable, "-c", READ, str(path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as run:
        path.write_bytes((recordings / "sound.flac").read_bytes())
        assert run.stdout is not None
        assert run.stdout.read().split()[-1] == b"2.0"


@pytest.mark.parametrize("name", ["sound.mp3", "index-first.m4a", "sound.flac", "vorbis.ogg"])
def test_nothing_is_written_to_standard_error(recordings, tmp_path, name):
    data = bytearray((recordings / name).read_bytes())
    data[len(data) // 2 : len(data) // 2 + 200] = bytes(range(200))
    path = tmp_path / name
    path.write_bytes(data)
    code = "import sys, contextlib; from lipwright.audio import open_audio\nfrom lipwright.errors "
    code += "import *\nwith contextlib.suppress(LipwrightError): open_audio(sys.argv[1]).close()"
    run = subprocess.run([sys.executable, "-c", code, str(path)], capture_output=True, check=True)
    assert run.stderr == b""


LONG = """
import os, resource, sys, tempfile
from lipwright.audio import open_audio
from lipwright.errors import LipwrightError
if len(sys.argv) > 2:
    resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[2]), resource.RLIM_INFINITY))
try:
    with open_audio(sys.argv[1]) as file:
        print(round(file.duration), os.listdir(tempfile.gettempdir()))
except LipwrightError as error:
    print(error)
"""


@pytest.mark.skipif(os.name != "posix", reason="file size limits are POSIX")
def test_decoded_sound_leaves_no_file_and_a_full_disk_is_an_error(tmp_path):
    path, folder = tmp_path / "long.wav", tmp_path / "temporary"
    folder.mkdir()
    soundfile.write(path, np.zeros(300 * RATE, np.int16), RATE)
    command = [sys.executable, "-c", LONG, str(path)]
    environment = {**os.environ, "TMPDIR": str(folder)}
    run = subprocess.run(command, capture_output=True, text=True, env=environment, check=True)
    assert run.stdout == "300 []\n"  # it has no name, so nothing can be left behind
    run = subprocess.run(
        [*command, "1000000"], capture_output=True, text=True, env=environment, check=True
    )
    assert f"{path}: its decoded sound does not fit into {folder}; set TMPDIR" in run.stdout
    assert list(folder.iterdir()) == []


def test_a_long_recording_is_read_in_bounded_memory(tmp_path):
    path = tmp_path / "long.flac"
    with soundfile.SoundFile(path, "w", 48000, 2, "PCM_16") as file:
        second = np.repeat(tone(1, 48000)[:, None], 2, 1)
        for _ in range(400):
            file.write(second)
    tracemalloc.start()
    try:
        with open_audio(path, RATE) as audio:
            assert audio.duration == pytest.approx(400)
            assert len(level_db(audio)) == 40000
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 40e6  # bytes; the whole would be 26 MB at 16 kHz, 154 MB as it lies in the file


def test_modules_that_are_slow_to_load_are_loaded_when_they_are_used():
    code = "import lipwright.audio, sys; print({'av', 'soundfile', 'soxr'} & set(sys.modules))"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "set()"


def try_to_read(data: bytes, folder: Path) -> AudioFile | None:
    path = folder / "fuzz"
    path.write_bytes(data)
    try:
        file = open_audio(path, RATE)
    except LipwrightError as error:
        if "\n" in str(error):
            pytest.fail(f"more than one line: {error}")
        return None
    with file:
        for block in file.blocks():
            assert np.isfinite(block.samples).all()
    return file


HEADS = [b"", b"RIFF\x24\0\0\0WAVEfmt ", b"fLaC", b"OggS\0\2", b"ID3\4", b"\0\0\0\x20ftypM4A ",
         b"\x1aE\xdf\xa3", b"FORM\0\0\0\x20AIFF", b"\xff\xf1\x50", b".snd", b"caff\0\1",
         b"\xff\xfb"]  # fmt: skip


@settings(max_examples=150, deadline=None)
@given(st.sampled_from(HEADS), st.binary(max_size=300))
def test_any_bytes_give_sound_or_a_clear_error(tmp_path_factory, head, data):
    try_to_read(head + data, tmp_path_factory.getbasetemp())


@settings(max_examples=250, deadline=None)
@given(data=st.data())
def test_damaged_files_give_sound_or_a_clear_error(recordings, tmp_path_factory, data):
    content = bytearray((recordings / data.draw(st.sampled_from(list(MAKERS)))).read_bytes())
    # Headers are where most can go wrong.
    places = st.one_of(st.integers(0, min(600, len(content) - 1)), st.integers(0, len(content) - 1))
    for _ in range(data.draw(st.integers(1, 8))):
        content[data.draw(places)] = data.draw(st.integers(0, 255))
    start = data.draw(st.sampled_from([0, 0, 0, 100]))
    stop = data.draw(st.one_of(st.just(len(content)), st.integers(0, len(content))))
    try_to_read(bytes(content[start:stop]), tmp_path_factory.getbasetemp())
