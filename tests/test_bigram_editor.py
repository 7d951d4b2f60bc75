"""The bigram editor: its server by real requests, its journal, and its page in a real browser."""

from __future__ import annotations

import json
import os
import re
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from lipwright.bigrams.families import load_bigrams
from lipwright.bigrams.file import load_set
from lipwright.bigrams.spline import dense
from lipwright.bigrams.values import Bigram
from lipwright.cli import run
from lipwright.errors import LipwrightError
from lipwright.face.head import Head
from lipwright.studio.desk import Desk
from lipwright.studio.errors import ConflictError
from lipwright.studio.guard import MAX_BODY, is_ours
from lipwright.studio.journal import journal_path, only_editor
from lipwright.studio.line import final_curves
from lipwright.studio.serve import listen
from lipwright.studio.workspace import Workspace, unsaved_edits
from studio_server import F_AH, TEXT, serving, write_faceless_set, write_set

NEW = {"FV": [[0.0, 0.0], [0.3, 0.9], [0.6, 0.0]]}


@pytest.fixture
def small(tmp_path: Path) -> Path:
    return write_set(tmp_path / "small.json")


@pytest.fixture
def client(small: Path) -> Iterator[httpx.Client]:
    with serving(Workspace(str(small))) as found:
        yield found


@pytest.fixture(scope="module")
def bystander(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    """One server for all that changes nothing."""
    path = write_set(tmp_path_factory.mktemp("set") / "small.json")
    with serving(Workspace(str(path))) as found:
        yield found


def revision(client: httpx.Client) -> int:
    return int(client.get("/api/set").json()["status"]["revision"])


def edit(client: httpx.Client, curves: Any = NEW, pair: str = "f ah") -> httpx.Response:
    body = {"pair": pair, "curves": curves, "revision": revision(client)}
    return client.put("/api/pair", json=body)


def act(client: httpx.Client, what: str, **more: Any) -> httpx.Response:
    return client.post(f"/api/{what}", json={"revision": revision(client), **more})


# ---- what an animator does


def test_the_page_begins_with_the_whole_set_and_the_curves_of_the_line(
    client: httpx.Client, small: Path
) -> None:
    answer = client.get("/api/set").json()
    assert [pose["name"] for pose in answer["set"]["poses"]] == ["open", "FV", "W"]
    assert answer["status"]["sources"] == {"f ah": "fitted", "ah d": "drawn"}
    assert [phone["phone"] for phone in answer["line"]["phones"]][1:3] == ["F", "AE"]
    desk = Desk(Workspace(str(small)), TEXT)
    assert desk.line is not None
    clip = final_curves(load_bigrams(small), desk.line.track)
    np.testing.assert_allclose(answer["motion"]["curves"]["FV"], clip.curve("FV"), atol=1e-4)
    assert [one["pair"] for one in answer["motion"]["pairs"]][:2] == ["sil f", "f ah"]


def test_a_pair_comes_with_its_points_and_the_spline_that_they_make(client: httpx.Client) -> None:
    pair = client.get("/api/pair", params={"pair": "f ah"}).json()
    assert pair["curves"]["FV"] == [list(point) for point in F_AH["FV"]]
    np.testing.assert_allclose(pair["dense"]["FV"], dense(F_AH["FV"]), atol=1e-4)
    assert (pair["count"], pair["variance"]) == (7, {"FV": 0.01})


def test_a_preview_shows_what_an_edit_would_make_and_keeps_nothing(
    client: httpx.Client, small: Path
) -> None:
    before = client.get("/api/set").json()
    shown = client.post("/api/preview", json={"pair": "f ah", "curves": NEW}).json()
    assert client.get("/api/set").json() == before
    assert not journal_path(small).exists()
    made = edit(client).json()
    assert shown["dense"] == made["pair"]["dense"]
    assert shown["motion"] == made["motion"] != before["motion"]


def test_a_saved_edit_is_in_the_file_and_drawn(client: httpx.Client, small: Path) -> None:
    assert edit(client).json()["status"]["unsaved"] == ["f ah"]
    saved = act(client, "save").json()
    assert saved["status"]["unsaved"] == []
    bigram = load_set(small).bigrams["f", "ah"]
    assert bigram.curves == {"FV": ((0.0, 0.0), (0.3, 0.9), (0.6, 0.0))}
    assert (bigram.source, bigram.count, bigram.variance) == ("drawn", 0, {})
    assert load_set(small).bigrams["ah", "d"].source == "drawn"
    assert not journal_path(small).exists()


def test_undo_and_redo_go_back_and_forth_also_over_a_save(
    client: httpx.Client, small: Path
) -> None:
    first = client.get("/api/pair", params={"pair": "f ah"}).json()
    second = edit(client).json()["pair"]
    edit(client, {})
    assert act(client, "undo").json()["pair"] == second
    back = act(client, "undo").json()
    assert (back["pair"], back["status"]["unsaved"]) == (first, [])
    assert act(client, "redo").json()["pair"] == second
    act(client, "save")
    assert act(client, "undo").json()["status"]["unsaved"] == ["f ah"]
    assert act(client, "redo").json()["status"]["unsaved"] == []
    act(client, "undo")
    act(client, "save")
    assert load_set(small).bigrams["f", "ah"].source == "fitted"
    assert act(client, "undo").status_code == 409


def test_curves_that_are_what_they_were_change_nothing(client: httpx.Client, small: Path) -> None:
    same = {pose: [list(point) for point in points] for pose, points in F_AH.items()}
    status = edit(client, same).json()["status"]
    assert (status["unsaved"], status["undo"]) == ([], "")
    assert not journal_path(small).exists()


def test_a_missing_pair_names_what_stands_in_for_it(client: httpx.Client) -> None:
    pair = client.get("/api/pair", params={"pair": "d ah"}).json()
    assert (pair["missing"], pair["stand_in"], pair["curves"]) == (True, "f ah", {})


def test_a_new_pair_is_added_and_a_pair_of_the_root_removed(
    client: httpx.Client, small: Path
) -> None:
    edit(client, pair="sil f")
    act(client, "revert", pair="ah d")
    act(client, "save")
    assert set(load_set(small).bigrams) == {("f", "ah"), ("sil", "f")}


def test_another_line_gives_its_phones_and_curves(client: httpx.Client) -> None:
    answer = client.post("/api/line", json={"text": "A  fan"}).json()
    assert answer["line"]["text"] == "A fan"
    assert [word["text"] for word in answer["line"]["words"]] == ["a", "fan"]
    assert client.get("/api/set").json()["line"] == answer["line"]


def test_the_head_shows_the_poses_and_refuses_others(client: httpx.Client, head: Head) -> None:
    del head
    shut, wide_open = (
        client.post("/api/picture", json={"poses": {"open": weight}}) for weight in (0.0, 1.0)
    )
    assert shut.content.startswith(b"\x89PNG")
    assert shut.content != wide_open.content
    for poses in ({"none": 1.0}, {"open": 1e9}):
        assert client.post("/api/picture", json={"poses": poses}).status_code == 400


def test_a_set_whose_rig_has_no_look_has_no_picture_and_says_why(
    tmp_path: Path, head: Head
) -> None:
    del head
    path = write_faceless_set(tmp_path / "boxes.json")
    with serving(Workspace(str(path))) as client:
        assert "does not say how its poses look" in client.get("/api/set").json()["picture"]
        assert client.post("/api/picture", json={"poses": {}}).status_code == 400


# ---- children


def test_a_child_gets_only_the_pairs_that_were_edited_and_the_parent_is_not_touched(
    small: Path,
) -> None:
    before = small.read_bytes()
    child = small.with_name("child.json")
    with serving(Workspace(str(small), child)) as client:
        status = client.get("/api/set").json()["status"]
        assert status["inherited"] == ["f ah", "ah d"]
        assert not status["exists"]
        assert edit(client).json()["status"]["inherited"] == ["ah d"]
        act(client, "save")
    assert small.read_bytes() == before
    said = load_set(child)
    assert (said.parent, set(said.bigrams)) == ("small.json", {("f", "ah")})
    assert load_bigrams(child).bigrams["ah", "d"].curves == {"open": ((0.0, 0.4), (1.0, 0.0))}
    with serving(Workspace(str(child))) as client:
        reverted = act(client, "revert", pair="f ah").json()
        assert reverted["pair"]["source"] == "fitted"
        assert reverted["status"]["inherited"] == ["f ah", "ah d"]
        act(client, "save")
    assert not load_set(child).bigrams


def test_a_set_that_is_not_our_file_is_edited_as_a_child(tmp_path: Path) -> None:
    corpus = Path(__file__).parents[2] / "shared" / "corpora" / "smartbody-bigrams"
    if not corpus.is_dir():
        pytest.skip("the SmartBody sets are not here")
    here = Path.cwd()
    os.chdir(tmp_path)
    try:
        workspace = Workspace(str(corpus / "default.json"))
    finally:
        os.chdir(here)
    assert workspace.path == Path("my-default.json")
    assert not workspace.exists
    assert workspace.is_inherited(("f", "ah"))


def test_a_file_of_other_parents_is_not_taken_for_a_child(small: Path) -> None:
    other = write_set(small.with_name("other.json"))
    with pytest.raises(LipwrightError, match=r"other.json: is no child of .*small.json"):
        Workspace(str(small), other)
    with pytest.raises(LipwrightError, match="is the set itself"):
        Workspace(str(small), small)
    with pytest.raises(LipwrightError, match="folder does not exist"):
        Workspace(str(small), small.parent / "none" / "a.json")
    with pytest.raises(LipwrightError, match=r"written as \.json"):
        Workspace(str(small), small.with_suffix(".txt"))


# ---- nothing is lost


def test_every_edit_is_in_the_journal_before_it_is_answered(
    client: httpx.Client, small: Path
) -> None:
    edit(client)
    path, pairs = unsaved_edits(str(small))
    assert (path, pairs) == (small, ("f ah",))
    act(client, "undo")
    assert unsaved_edits(str(small))[1] == ()


@contextmanager
def editor(path: Path) -> Iterator[tuple[subprocess.Popen[str], httpx.Client]]:
    """The program as it is started by hand."""
    command = [sys.executable, "-m", "lipwright", "bigrams", "editor", str(path), "--no-open"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        line = process.stderr.readline()
        assert "Ctrl-C ends it" in line, line + process.stderr.read()
        url = re.findall(r"http://127\.0\.0\.1:\d+/", line)[0]
        with httpx.Client(base_url=url, timeout=30, trust_env=False) as client:
            yield process, client


def test_edits_of_a_killed_editor_are_offered_taken_up_and_saved(small: Path) -> None:
    with editor(small) as (killed, client):
        for height in range(1, 20):
            curves = {"FV": [[0.0, 0.0], [0.5, height / 20], [1.0, 0.0]]}
            assert edit(client, curves).status_code == 200
        killed.send_signal(signal.SIGKILL)
    assert load_set(small).bigrams["f", "ah"].source == "fitted"
    with editor(small) as (ended, client):
        status = client.get("/api/set").json()["status"]
        assert (status["pending"], status["stale"]) == (["f ah"], False)
        assert edit(client).status_code == 409  # first the decision
        ended.send_signal(signal.SIGINT)  # Ctrl-C
        assert ended.wait() == 0
        assert ended.stderr is not None
        kept = "1 unsaved pair is kept in small.json.unsaved for the next time"
        assert ended.stderr.read() == f"{small}: {kept}\n"
    with serving(Workspace(str(small))) as client:
        taken = client.post("/api/recover", json={"keep": True}).json()
        assert (taken["status"]["unsaved"], taken["status"]["pending"]) == (["f ah"], [])
        act(client, "save")
    assert load_set(small).bigrams["f", "ah"].curves["FV"][1] == (0.5, 0.95)
    assert [path.name for path in small.parent.iterdir()] == ["small.json"]


def test_an_address_that_cannot_be_had_is_said_in_a_line(
    small: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with listen("127.0.0.1", 0) as taken:
        port = str(taken.getsockname()[1])
        for address in (["--port", port], ["--host", "203.0.113.1"], ["--host", "no such host"]):
            assert run(["bigrams", "editor", str(small), "--no-open", *address]) == 2
            error = capsys.readouterr().err
            assert "cannot be listened on" in error
            assert error.count("\n") == 1


@pytest.mark.parametrize("module", ["fastapi", "uvicorn"])
def test_a_missing_package_is_named_with_the_command_that_brings_it(
    module: str, small: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    assert run(["bigrams", "editor", str(small), "--no-open"]) == 2
    said = f"lipwright: {module} is not installed; run: pip install 'lipwright[studio]'\n"
    assert capsys.readouterr().err == said


def test_what_is_unsaved_is_said_without_a_server(
    small: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["bigrams", "editor", str(small), "--unsaved"]
    assert run(command) == 0
    assert capsys.readouterr().err == f"{small}: no unsaved edits\n"
    Workspace(str(small)).edit(Bigram("f", "ah", {}), 1)
    assert run(command) == 0
    assert capsys.readouterr().err == f"{small}: not saved: f ah\n"


def test_pending_edits_can_be_forgotten(small: Path) -> None:
    Workspace(str(small)).edit(Bigram("f", "ah", {}), 1)
    workspace = Workspace(str(small))
    workspace.recover(keep=False)
    assert not journal_path(small).exists()
    assert workspace.bigrams.bigrams["f", "ah"].source == "fitted"


def test_a_journal_of_what_is_in_the_file_already_asks_nothing(small: Path) -> None:
    workspace = Workspace(str(small))
    workspace.edit(Bigram("f", "ah", {}), 1)
    journal = journal_path(small).read_bytes()
    workspace.save(workspace.revision)
    journal_path(small).write_bytes(journal)  # as if it were killed before the end of the save
    assert Workspace(str(small)).pending is None


def test_a_damaged_journal_is_named_and_kept(small: Path) -> None:
    for content in ("{", "[]", '{"format": "lipwright-bigrams-unsaved", "version": 1}'):
        journal_path(small).write_text(content)
        with pytest.raises(LipwrightError, match=r"small.json.unsaved: .*move it away"):
            Workspace(str(small))
        assert journal_path(small).read_text() == content


def test_a_file_that_another_program_changed_is_not_overwritten(
    client: httpx.Client, small: Path
) -> None:
    edit(client)
    write_set(small, licence="MIT")
    refused = act(client, "save")
    assert refused.status_code == 409
    assert "another program has changed the file" in refused.json()["error"]
    assert load_set(small).licence == "MIT"
    assert load_set(small).bigrams["f", "ah"].source == "fitted"
    again = client.post("/api/reload", json={"keep": True}).json()
    assert (again["set"]["licence"], again["status"]["unsaved"]) == ("MIT", ["f ah"])
    act(client, "save")
    assert (load_set(small).licence, load_set(small).bigrams["f", "ah"].source) == ("MIT", "drawn")


def test_reloading_can_drop_the_edits(client: httpx.Client, small: Path) -> None:
    edit(client)
    write_set(small)
    answer = client.post("/api/reload", json={"keep": False}).json()
    assert answer["status"]["unsaved"] == []
    assert not journal_path(small).exists()


def test_a_file_that_was_removed_is_written_anew_after_a_reload(
    client: httpx.Client, small: Path
) -> None:
    edit(client)
    small.unlink()
    assert act(client, "save").status_code == 409
    client.post("/api/reload", json={"keep": True})
    assert act(client, "save").status_code == 200
    assert set(load_set(small).bigrams) == {("f", "ah"), ("ah", "d")}


def test_of_two_pages_the_one_that_is_behind_is_refused(client: httpx.Client) -> None:
    old = revision(client)
    edit(client)
    body = {"pair": "f ah", "curves": {}, "revision": old}
    refused = client.put("/api/pair", json=body)
    assert refused.status_code == 409
    assert "another window" in refused.json()["error"]


def test_a_set_has_one_editor_at_a_time(small: Path) -> None:
    with (
        only_editor(small),
        pytest.raises(LipwrightError, match="another editor has it open"),
        only_editor(small),
    ):
        pass
    assert [path.name for path in small.parent.iterdir()] == ["small.json"]


def test_an_edit_whose_journal_cannot_be_written_is_refused_and_undone(small: Path) -> None:
    workspace = Workspace(str(small))
    journal_path(small).mkdir()
    with pytest.raises(LipwrightError, match="is a folder"):
        workspace.edit(Bigram("f", "ah", {}), workspace.revision)
    assert workspace.unsaved == ()
    assert workspace.undoable is None
    assert workspace.bigrams.bigrams["f", "ah"].source == "fitted"


def test_a_workspace_with_pending_edits_wants_a_decision_first(small: Path) -> None:
    Workspace(str(small)).edit(Bigram("f", "ah", {}), 1)
    workspace = Workspace(str(small))
    for action in (lambda: workspace.save(1), lambda: workspace.undo(1)):
        with pytest.raises(ConflictError, match="first decide"):
            action()


# ---- attempts to break in


def test_where_it_listens_everywhere_numbers_are_its_name_and_words_are_not() -> None:
    for host, name, ours in [
        ("0.0.0.0", "192.168.1.7:80", True), ("0.0.0.0", "[fe80::1]:80", True),
        ("0.0.0.0", "evil.example:80", False), ("::", "192.168.1.7:80", True),
        ("studio.local", "studio.local:80", True), ("studio.local", "evil.example:80", False),
        ("127.0.0.1", "192.168.1.7:80", False), ("::1", "[::1]:80", True),
    ]:  # fmt: skip
        assert is_ours(name, host, 80) is ours, (host, name)


def refused(response: httpx.Response, status: int) -> str:
    assert response.status_code == status, response.text
    message = response.json()["error"]
    assert "\n" not in message
    assert "Traceback" not in message
    return str(message)


@pytest.mark.parametrize(
    "host",
    ["evil.example", "127.0.0.1", "127.0.0.1:1", "localhost.evil.example:{port}",
     "user@127.0.0.1:{port}", "", "127.0.0.1:{port}/x", "10.0.0.1:{port}"],
)  # fmt: skip
def test_other_host_names_get_nothing(bystander: httpx.Client, host: str) -> None:
    named = host.format(port=bystander.base_url.port)
    for path in ("/", "/api/set", "/page/main.js"):
        refused(bystander.get(path, headers={"Host": named}), 421)


def test_the_own_names_of_the_address_are_answered(bystander: httpx.Client) -> None:
    for name in ("localhost", "127.0.0.1"):
        headers = {"Host": f"{name}:{bystander.base_url.port}"}
        assert bystander.get("/api/set", headers=headers).status_code == 200


@pytest.mark.parametrize(
    "headers",
    [{"Origin": "http://evil.example"}, {"Origin": "null"}, {"Origin": "http://127.0.0.1:1"},
     {"Sec-Fetch-Site": "cross-site"}, {"Sec-Fetch-Site": "same-site"}],
)  # fmt: skip
def test_requests_of_other_sites_are_refused_and_change_nothing(
    bystander: httpx.Client, headers: dict[str, str]
) -> None:
    body = {"pair": "f ah", "curves": {}, "revision": revision(bystander)}
    refused(bystander.put("/api/pair", json=body, headers=headers), 403)
    refused(bystander.get("/api/set", headers=headers), 403)
    assert bystander.get("/api/pair", params={"pair": "f ah"}).json()["source"] == "fitted"


def test_forms_of_other_sites_cannot_be_mistaken_for_edits(bystander: httpx.Client) -> None:
    body = json.dumps({"revision": revision(bystander)})
    for kind in ("text/plain", "application/x-www-form-urlencoded", ""):
        refused(bystander.post("/api/save", content=body, headers={"Content-Type": kind}), 415)


def test_every_answer_forbids_foreign_scripts_frames_and_readers(bystander: httpx.Client) -> None:
    for response in (
        bystander.get("/"),
        bystander.get("/nowhere"),
        bystander.put("/api/pair", json={}),
    ):
        policy = response.headers["content-security-policy"]
        assert "default-src 'none'" in policy
        assert "unsafe" not in policy
        assert "frame-ancestors 'none'" in policy
        assert response.headers["x-content-type-options"] == "nosniff"
        assert "access-control-allow-origin" not in response.headers


@pytest.mark.parametrize(
    "path",
    ["/page/../api.py", "/page/%2e%2e/api.py", "/page/..%2fapi.py", "/page//etc/passwd",
     "/page/%2fetc%2fpasswd", "/page/index.html%00.js", "/..%2f..%2fetc/passwd", "/docs",
     "/openapi.json", "/page/"],
)  # fmt: skip
def test_no_path_leads_out_of_the_page(bystander: httpx.Client, path: str) -> None:
    port = bystander.base_url.port
    with socket.create_connection(("127.0.0.1", port)) as raw:
        request = f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nConnection: close\r\n\r\n"
        raw.sendall(request.encode())
        answer = b"".join(iter(lambda: raw.recv(65536), b""))
    assert answer.startswith(b"HTTP/1.1 404"), answer[:200]
    assert b"root:" not in answer


def test_a_body_of_fifty_megabytes_is_refused_and_the_server_goes_on(
    bystander: httpx.Client,
) -> None:
    for content in (b"x" * 50_000_000, (b"x" * 65536 for _ in range(800))):
        try:
            response = bystander.post(
                "/api/save", content=content, headers={"Content-Type": "application/json"}
            )
        except httpx.TransportError:  # it hung up while we were still sending
            continue
        assert f"{MAX_BODY >> 20} MB" in refused(response, 413)
    assert bystander.get("/api/set").status_code == 200


BAD_CURVES = [
    ({"none": [[0, 0]]}, 400, "no pose 'none'"),
    ({"FV": []}, 400, "control points"),
    ({"FV": [[0, 0]] * 201}, 400, "1 to 200"),
    ({"FV": [[0.5, 0], [0.2, 0]]}, 400, "order of time"),
    ({"FV": [[-5, 0]]}, 400, "not within 0 to 1"),
    ({"FV": [[0, 1e9]]}, 400, "give -10 to 10"),
    ({"FV": [[0, 1e999]]}, 422, "finite"),
    ({"FV": [[0]]}, 422, "at least 2 items"),
    ({"FV": [[0, "1"]]}, 422, "valid number"),
    ({"FV": [[0, True]]}, 422, "valid number"),
    ({"FV": [[0, None]]}, 422, "valid number"),
    ({"FV": "points"}, 422, "valid list"),
    ([], 422, "valid dictionary"),
    (None, 422, "valid dictionary"),
]


@pytest.mark.parametrize(("curves", "status", "why"), BAD_CURVES)
def test_curves_that_are_none_are_refused_in_one_line(
    bystander: httpx.Client, curves: Any, status: int, why: str
) -> None:
    known = revision(bystander)
    for method, path in (("PUT", "/api/pair"), ("POST", "/api/preview")):
        body = {"pair": "f ah", "curves": curves} | ({"revision": known} if method == "PUT" else {})
        # httpx refuses to write numbers that JSON has not; others may not.
        content = json.dumps(body)
        headers = {"Content-Type": "application/json"}
        assert why in refused(
            bystander.request(method, path, content=content, headers=headers), status
        )
    assert revision(bystander) == known


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity"])
def test_numbers_that_json_does_not_have_are_refused(bystander: httpx.Client, number: str) -> None:
    content = f'{{"pair": "f ah", "curves": {{"FV": [[0, {number}]]}}}}'
    headers = {"Content-Type": "application/json"}
    refused(bystander.post("/api/preview", content=content, headers=headers), 422)


@pytest.mark.parametrize(
    ("body", "status"),
    [({"pair": "x y", "curves": {}}, 400), ({"pair": "f", "curves": {}}, 400),
     ({"pair": "f  ah", "curves": {}}, 400), ({"pair": "../x ah", "curves": {}}, 400),
     ({"pair": 5, "curves": {}}, 422), ({"pair": "f ah"}, 422), ([], 422), ("text", 422),
     ({"pair": "f ah", "curves": {}, "more": 1}, 422),
     ({"pair": "f ah", "curves": {}, "note": "x" * 501}, 422), ({"pair": "f" * 999}, 422)],
)  # fmt: skip
def test_edits_of_nothing_are_refused(bystander: httpx.Client, body: Any, status: int) -> None:
    refused(bystander.post("/api/preview", json=body), status)


def test_what_is_no_json_is_refused(bystander: httpx.Client) -> None:
    headers = {"Content-Type": "application/json"}
    for content, status in ((b"", 422), (b"{", 422), (b"\xff\xfe", 422), (b"[" * 100_000, 400)):
        refused(bystander.post("/api/line", content=content, headers=headers), status)
    assert bystander.get("/api/set").status_code == 200


@pytest.mark.parametrize("text", ["", "...", "x " * 400, "\x00", "你好"])
def test_lines_that_cannot_be_said_are_refused(bystander: httpx.Client, text: str) -> None:
    refused(bystander.post("/api/line", json={"text": text}), 400)


def test_only_reading_and_writing_is_answered(bystander: httpx.Client) -> None:
    for method in ("DELETE", "PATCH", "OPTIONS", "TRACE"):
        refused(bystander.request(method, "/api/pair"), 405)


def test_a_class_with_odd_letters_reaches_the_page_only_as_json(tmp_path: Path) -> None:
    name = "<img/src=x>"
    path = write_set(tmp_path / "odd.json", classes={name: ("F",)}, bigrams={})
    with serving(Workspace(str(path)), "fff") as client:
        answer = client.get("/api/set")
        assert answer.headers["content-type"] == "application/json"
        assert answer.json()["set"]["classes"][0]["name"] == name
