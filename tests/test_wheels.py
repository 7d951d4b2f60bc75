"""Pinned wheels: what is fetched is checked before it is used."""

import hashlib
import subprocess
import zipfile
from pathlib import Path

import pytest

from lipwright.errors import LipwrightError
from lipwright.wheels import Wheel, data_home, fetch_wheel, read_members

MEMBER = "part/data.txt"


@pytest.fixture
def archive(tmp_path: Path) -> Path:
    path = tmp_path / "part-1.0-py3-none-any.whl"
    with zipfile.ZipFile(path, "w") as wheel:
        wheel.writestr(MEMBER, "content")
    return path


def pinned(path: Path) -> Wheel:
    return Wheel("part", "1.0", hashlib.sha256(path.read_bytes()).hexdigest())


def test_members_come_out_of_the_pinned_wheel(archive: Path) -> None:
    assert read_members(archive, pinned(archive), [MEMBER]) == {MEMBER: b"content"}


def test_another_wheel_is_refused_with_both_hashes(archive: Path) -> None:
    expected = Wheel("part", "1.0", "0" * 64)
    with pytest.raises(LipwrightError) as refused:
        read_members(archive, expected, [MEMBER])
    message = str(refused.value)
    assert str(archive) in message
    assert "0" * 64 in message
    assert pinned(archive).sha256 in message
    assert "\n" not in message


def test_a_missing_member_is_named(archive: Path) -> None:
    with pytest.raises(LipwrightError, match=r"part/absent\.txt.*fetch part==1\.0 again"):
        read_members(archive, pinned(archive), ["part/absent.txt"])


@pytest.mark.parametrize("content", [b"", b"not a zip file", b"PK\x03\x04 cut off"])
def test_a_broken_wheel_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "broken.whl"
    path.write_bytes(content)
    with pytest.raises(LipwrightError, match=r"broken\.whl"):
        read_members(path, pinned(path), [MEMBER])


def test_a_missing_wheel_is_named(tmp_path: Path) -> None:
    with pytest.raises(LipwrightError, match=r"absent\.whl"):
        read_members(tmp_path / "absent.whl", Wheel("part", "1.0", "0" * 64), [MEMBER])


def test_a_failed_download_is_one_line_with_a_remedy(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(command: list[str], **_: object) -> subprocess.CompletedProcess[str]:
        return subprocess.CompletedProcess(command, 1, "", "WARNING: slow\nERROR: no route\n")

    monkeypatch.setattr(subprocess, "run", fail)
    with pytest.raises(LipwrightError) as refused:
        fetch_wheel(Wheel("part", "1.0", "0" * 64), tmp_path)
    message = str(refused.value)
    assert message.startswith("part==1.0 could not be fetched: ERROR: no route")
    assert "--wheel" in message
    assert "\n" not in message


def test_data_home_follows_the_environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LIPWRIGHT_HOME", str(tmp_path / "own"))
    assert data_home() == tmp_path / "own"
    monkeypatch.delenv("LIPWRIGHT_HOME")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    assert data_home() == tmp_path / "cache" / "lipwright"
