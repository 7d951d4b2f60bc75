"""Files are written whole or not at all."""

from __future__ import annotations

import errno
import os
import stat
import threading
from pathlib import Path

import pytest

from lipwright.errors import LipwrightError, MissingExtraError
from lipwright.files import write_whole

OLD, NEW = "old", "new"


def only(folder: Path) -> dict[str, str]:
    """Every file of a folder, hidden ones too, with its text."""
    return {path.name: path.read_text() for path in folder.iterdir()}


def write(target: Path, error: BaseException | None = None) -> None:
    """Write the new text to a target; fail with `error` after that."""
    with write_whole(target) as part:
        part.write_text(NEW)
        if error is not None:
            raise error


def test_a_new_file_appears_with_its_content_and_nothing_beside_it(tmp_path: Path) -> None:
    with write_whole(tmp_path / "a.csv") as part:
        part.write_text(NEW)
        assert not (tmp_path / "a.csv").exists()
    assert only(tmp_path) == {"a.csv": NEW}


def test_an_older_file_stays_until_the_block_ends_and_is_then_replaced(tmp_path: Path) -> None:
    target = tmp_path / "a.csv"
    target.write_text(OLD)
    with write_whole(str(target)) as part:
        part.write_text(NEW)
        assert target.read_text() == OLD
    assert only(tmp_path) == {"a.csv": NEW}


@pytest.mark.parametrize(
    "error", [RuntimeError("x"), LipwrightError("x"), KeyboardInterrupt(), SystemExit(1)]
)
def test_whatever_ends_the_block_early_leaves_the_older_file_and_no_part(
    tmp_path: Path, error: BaseException
) -> None:
    target = tmp_path / "a.csv"
    target.write_text(OLD)
    with pytest.raises(type(error)):
        write(target, error)
    assert only(tmp_path) == {"a.csv": OLD}


def test_a_full_disk_is_one_line_that_names_the_target(tmp_path: Path) -> None:
    target = tmp_path / "a.csv"
    target.write_text(OLD)
    with pytest.raises(LipwrightError) as caught:
        write(target, OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)))
    assert str(caught.value) == f"{target}: cannot be written: No space left on device"
    assert only(tmp_path) == {"a.csv": OLD}


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
def test_a_device_is_refused_and_left_alone() -> None:
    with pytest.raises(LipwrightError, match="is a device or pipe"), write_whole("/dev/full"):
        pytest.fail("the block ran")
    assert stat.S_ISCHR(Path("/dev/full").stat().st_mode)


def test_a_pipe_is_refused_and_left_alone(tmp_path: Path) -> None:
    pipe = tmp_path / "a.csv"
    os.mkfifo(pipe)
    with pytest.raises(LipwrightError, match="is a device or pipe"), write_whole(pipe):
        pytest.fail("the block ran")
    assert pipe.is_fifo()


def test_a_folder_is_refused_before_the_block_runs(tmp_path: Path) -> None:
    with pytest.raises(LipwrightError, match="is a folder; name a file"), write_whole(tmp_path):
        pytest.fail("the block ran")


def test_a_missing_folder_is_named_with_the_reason(tmp_path: Path) -> None:
    target = tmp_path / "missing" / "a.csv"
    with pytest.raises(LipwrightError, match="No such file or directory") as caught:
        write(target)
    assert str(caught.value).startswith(f"{target}: ")
    assert only(tmp_path) == {}


def test_a_file_where_the_folder_should_be_is_a_clear_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text(OLD)
    with pytest.raises(LipwrightError, match="Not a directory"):
        write(tmp_path / "file" / "a.csv")
    assert only(tmp_path) == {"file": OLD}


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write to every folder")
def test_a_read_only_folder_is_a_clear_error(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    with pytest.raises(LipwrightError, match="Permission denied"):
        write(tmp_path / "a.csv")
    tmp_path.chmod(0o700)


def test_a_name_that_the_file_system_refuses_is_a_clear_error(tmp_path: Path) -> None:
    with pytest.raises(LipwrightError, match="File name too long"):
        write(tmp_path / ("a" * 300))
    assert only(tmp_path) == {}


@pytest.mark.parametrize("name", ["a" * 251 + ".csv", "ü" * 125 + ".csv", "𝄞" * 62 + ".csv"])
def test_the_longest_names_can_be_written(tmp_path: Path, name: str) -> None:
    with write_whole(tmp_path / name) as part:
        part.write_text(NEW)
    assert only(tmp_path) == {name: NEW}


@pytest.mark.parametrize("name", ["a.csv", "a.livelink.csv", "a b.TextGrid", ".mp4", "a"])
def test_the_part_keeps_the_suffixes_and_lies_beside_the_target(tmp_path: Path, name: str) -> None:
    with write_whole(tmp_path / name) as part:
        part.write_text(NEW)
        assert part.name.endswith(name)
        assert part.parent == tmp_path.resolve()
        assert part.name.startswith(".")


def test_a_link_stays_a_link_and_the_file_that_it_names_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    target, link = tmp_path / "there" / "a.csv", tmp_path / "link.csv"
    target.write_text(OLD)
    link.symlink_to(target)
    with write_whole(link) as part:
        part.write_text(NEW)
    assert link.is_symlink()
    assert only(tmp_path / "there") == {"a.csv": NEW}


def test_a_relative_path_is_written_where_the_program_stands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with write_whole("a.csv") as part:
        part.write_text(NEW)
    assert only(tmp_path) == {"a.csv": NEW}


def test_writers_at_once_never_mix_and_the_file_is_one_of_theirs(tmp_path: Path) -> None:
    target = tmp_path / "a.csv"
    texts = [letter * 100_000 for letter in "abcdefgh"]
    together = threading.Barrier(len(texts))

    def write(text: str) -> None:
        with write_whole(target) as part:
            together.wait()
            part.write_text(text)

    threads = [threading.Thread(target=write, args=(text,)) for text in texts]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert target.read_text() in texts
    assert list(tmp_path.iterdir()) == [target]


def test_a_missing_extra_gives_the_command_that_installs_it() -> None:
    error = MissingExtraError("the face tracker", "capture")
    assert str(error) == (
        "the face tracker is not installed; run: pip install 'lipwright[capture]'"
    )
    assert error.extra == "capture"
    assert isinstance(error, LipwrightError)
