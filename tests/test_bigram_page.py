"""The bigram editor's page in a real browser, as an animator uses it."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import httpx
import pytest

from lipwright.bigrams.file import load_set
from lipwright.face.head import Head
from lipwright.studio.journal import journal_path
from lipwright.studio.workspace import Workspace
from studio_server import F_AH, TEXT, serving, write_faceless_set, write_set

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
ARGUMENTS = [
    "--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
]  # fmt: skip


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    found = next(filter(None, map(shutil.which, BROWSERS)), None)
    if found is None:
        pytest.skip("there is no Chromium here")
    with playwright.sync_playwright() as driver:
        chromium = driver.chromium.launch(executable_path=found, args=ARGUMENTS)
        yield chromium
        chromium.close()


@pytest.fixture(scope="module")
def opened_once(
    tmp_path_factory: pytest.TempPathFactory, browser: Browser
) -> Iterator[tuple[Path, Page, httpx.Client]]:
    path = write_faceless_set(tmp_path_factory.mktemp("set") / "small.json")
    with opened(path, browser) as (page, client):
        yield path, page, client


@pytest.fixture
def page(opened_once: tuple[Path, Page, httpx.Client]) -> Page:
    """The page of an editor of `small`, as if it were started anew."""
    path, page, client = opened_once
    write_faceless_set(path)
    assert client.post("/api/reload", json={"keep": False}).status_code == 200
    assert client.post("/api/line", json={"text": TEXT}).status_code == 200
    page.goto("about:blank")
    visit(page, str(client.base_url))
    return page


@pytest.fixture
def small(opened_once: tuple[Path, Page, httpx.Client]) -> Path:
    return opened_once[0]


@contextmanager
def opened(path: Path, browser: Browser) -> Iterator[tuple[Page, httpx.Client]]:
    """The page of an editor, in which no script may fail, and another way to its server."""
    with serving(Workspace(str(path))) as client:
        page = browser.new_page(viewport={"width": 1300, "height": 950})
        troubles: list[str] = []
        page.on("pageerror", lambda error: troubles.append(str(error)))
        page.on(
            "console",
            lambda message: troubles.append(message.text) if message.type == "error" else None,
        )
        visit(page, str(client.base_url))
        yield page, client
        page.close()
    # The browser also notes each request that the server refuses.
    assert not [line for line in troubles if "Failed to load resource" not in line], troubles


def visit(page: Page, url: str) -> None:
    page.goto(f"{url}/#f%20ah")
    page.wait_for_selector("body[data-ready]")


def circle(pose: str, index: int) -> str:
    return f'#curves circle[data-pose="{pose}"][data-index="{index}"]'


def drag(page: Page, selector: str, right: float, up: float) -> None:
    box: Any = page.locator(selector).bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + right / 2, y - up / 2)
    page.mouse.move(x + right, y - up)
    page.mouse.up()


def line_curve(page: Page) -> str | None:
    return page.locator("#said path.spline.chosen").first.get_attribute("d")


def until(page: Page, expression: str) -> None:
    """Wait until it holds; Playwright's own way needs `eval`, which the page forbids."""
    for _ in range(500):
        if page.evaluate(expression):
            return
        page.wait_for_timeout(20)
    pytest.fail(f"never: {expression}")


def wait_unsaved(page: Page, text: str) -> None:
    until(page, f"document.getElementById('saved').textContent === {text!r}")


def test_a_dragged_point_moves_the_curves_and_a_save_the_file(page: Page, small: Path) -> None:
    page.click('#poses .chip >> text="FV"')
    before, spline = line_curve(page), page.locator("#curves .chosen .spline").get_attribute("d")
    drag(page, circle("FV", 1), right=40, up=-120)
    wait_unsaved(page, "1 unsaved pair")
    assert line_curve(page) != before
    assert page.locator("#curves .chosen .spline").get_attribute("d") != spline
    assert load_set(small).bigrams["f", "ah"].curves == F_AH
    page.click("#save")
    wait_unsaved(page, "All saved")
    saved = load_set(small).bigrams["f", "ah"]
    assert saved.source == "drawn"
    (_, (time, value), _) = saved.curves["FV"]
    assert time > F_AH["FV"][1][0]
    assert value < F_AH["FV"][1][1] - 0.2
    assert saved.curves["open"] == F_AH["open"]


def test_the_face_follows_a_dragged_point(tmp_path: Path, browser: Browser, head: Head) -> None:
    del head
    with opened(write_set(tmp_path / "small.json"), browser) as (page, _):
        drawn = "Number(document.getElementById('picture').dataset.drawn)"
        until(page, f"{drawn} >= 1")
        before = page.evaluate(drawn)
        page.click('#poses .chip >> text="FV"')
        drag(page, circle("FV", 1), right=40, up=-120)
        until(page, f"{drawn} > {before}")
        assert "of the pair" in page.inner_text("#face-at")


def test_the_curves_of_the_line_follow_while_the_mouse_still_moves(page: Page) -> None:
    page.click('#poses .chip >> text="FV"')
    before = line_curve(page)
    box: Any = page.locator(circle("FV", 1)).bounding_box()
    page.mouse.move(box["x"] + 6, box["y"] + 6)
    page.mouse.down()
    page.mouse.move(box["x"] + 30, box["y"] + 150)
    until(
        page,
        f"document.querySelector('#said path.spline.chosen').getAttribute('d') !== {before!r}",
    )
    assert page.inner_text("#saved") == "All saved"
    page.mouse.up()
    wait_unsaved(page, "1 unsaved pair")


def test_points_are_added_and_removed_and_every_step_undone(page: Page, small: Path) -> None:
    page.click('#poses .chip >> text="open"')
    points = page.locator('#curves circle[data-pose="open"]')
    assert points.count() == 3
    box: Any = page.locator("#curves svg").bounding_box()
    page.mouse.dblclick(box["x"] + 0.8 * box["width"], box["y"] + 0.2 * box["height"])
    until(page, "document.querySelectorAll('#curves .chosen circle').length === 4")
    page.click(circle("open", 1), button="right")
    until(page, "document.querySelectorAll('#curves .chosen circle').length === 3")
    page.focus(circle("open", 0))
    page.keyboard.press("Delete")
    until(page, "document.querySelectorAll('#curves .chosen circle').length === 2")
    for count in (3, 4, 3):
        page.keyboard.press("Control+z")
        until(page, f"document.querySelectorAll('#curves .chosen circle').length === {count}")
    wait_unsaved(page, "All saved")
    page.keyboard.press("Control+Shift+z")
    wait_unsaved(page, "1 unsaved pair")
    assert journal_path(small).exists()


def test_quick_edits_lose_nothing_and_do_not_call_back_the_pair(page: Page, small: Path) -> None:
    page.click('#poses .chip >> text="open"')
    page.evaluate(
        """() => {
            document.querySelector('[aria-label="Remove FV"]').click();
            document.querySelector('#poses select').value = 'W';
            document.querySelector('#poses select').dispatchEvent(new Event('change'));
            document.querySelector('[data-pair="ah d"]').click();
        }"""
    )
    wait_unsaved(page, "1 unsaved pair")
    until(page, "document.getElementById('pair-title').textContent === 'ah → d'")
    page.keyboard.press("Control+s")
    wait_unsaved(page, "All saved")
    assert page.inner_text("#pair-title") == "ah → d"
    assert set(load_set(small).bigrams["f", "ah"].curves) == {"open", "W"}


def test_a_missing_pair_begins_with_the_curves_that_stand_in(page: Page, small: Path) -> None:
    page.click('#matrix button[data-pair="d ah"]')
    page.click('#facts >> text="Begin with the curves of f → ah"')
    wait_unsaved(page, "1 unsaved pair")
    page.click("#save")
    wait_unsaved(page, "All saved")
    assert load_set(small).bigrams["d", "ah"].curves == F_AH


def test_a_point_goes_as_far_as_its_neighbours(page: Page, small: Path) -> None:
    page.click('#poses .chip >> text="FV"')
    drag(page, circle("FV", 1), right=600, up=0)
    wait_unsaved(page, "1 unsaved pair")
    page.keyboard.press("Control+s")
    wait_unsaved(page, "All saved")
    assert load_set(small).bigrams["f", "ah"].curves["FV"][1] == (0.5, 1.0)


def test_numbers_are_typed_and_points_moved_by_keys(page: Page, small: Path) -> None:
    page.click('#poses .chip >> text="FV"')
    page.fill('#table input[aria-label="Value of point 2"]', "0.77")
    page.keyboard.press("Tab")
    wait_unsaved(page, "1 unsaved pair")
    page.focus(circle("FV", 1))
    for key in ("ArrowRight", "ArrowRight", "Shift+ArrowDown"):
        page.keyboard.press(key)
    page.keyboard.press("Control+s")
    wait_unsaved(page, "All saved")
    assert load_set(small).bigrams["f", "ah"].curves["FV"][1] == (0.22, 0.72)


def test_what_cannot_be_is_refused_in_a_line_and_the_page_goes_back(page: Page) -> None:
    page.click('#poses .chip >> text="FV"')
    time = page.locator('#table input[aria-label="Time of point 2"]')
    time.fill("0.9")
    time.press("Tab")
    page.wait_for_selector("#bars .error")
    assert "put them in order of time" in page.inner_text("#bars")
    until(
        page,
        "document.querySelector('#table input[aria-label=\"Time of point 2\"]').value === '0.2'",
    )


def test_poses_are_added_and_removed(page: Page, small: Path) -> None:
    page.select_option('#poses select[aria-label="Add a pose"]', "W")
    page.wait_for_selector(circle("W", 0))
    page.click('#poses button[aria-label="Remove FV"]')
    until(page, "document.querySelectorAll('#poses .chip').length === 2")
    page.click("#save")
    wait_unsaved(page, "All saved")
    assert set(load_set(small).bigrams["f", "ah"].curves) == {"open", "W"}


def test_phones_of_the_line_and_cells_of_the_matrix_lead_to_their_pair(page: Page) -> None:
    page.click('#matrix button[data-pair="ah d"]')
    until(page, "document.getElementById('pair-title').textContent === 'ah → d'")
    page.keyboard.press("ArrowUp")
    until(page, "document.getElementById('pair-title').textContent === 'f → d'")
    page.locator('#said [data-mark="1"]').click()
    until(page, "document.getElementById('pair-title').textContent === 'f → ah'")
    assert page.locator("#said .pair-span").count() == 1
    page.locator('#said rect[data-phone="3"]').click(position={"x": 2, "y": 4})
    until(page, "document.getElementById('pair-title').textContent === 'ah → d'")


def test_another_line_is_said_scrubbed_and_played(page: Page) -> None:
    page.fill("#text", "Vat")
    page.keyboard.press("Enter")
    until(
        page,
        "[...document.querySelectorAll('#said .word')].map(w => w.textContent).join() === 'vat'",
    )
    page.focus("#scrub")
    page.keyboard.press("End")
    assert (
        page.inner_text("#line-about").split(" of ")[0] == page.inner_text("#line-about").split()[2]
    )
    page.click("#play")
    until(page, "document.getElementById('play').textContent === 'Play'")
    page.fill("#text", "....")
    page.keyboard.press("Enter")
    page.wait_for_selector("#bars .error")


def test_edits_of_a_closed_tab_and_a_killed_server_are_taken_up_again(
    browser: Browser, tmp_path: Path
) -> None:
    small = write_faceless_set(tmp_path / "small.json")
    with opened(small, browser) as (page, _):
        page.click('#poses button[aria-label="Remove FV"]')
        wait_unsaved(page, "1 unsaved pair")
    with opened(small, browser) as (page, _):
        assert "Edits of the last time were not saved: f → ah" in page.inner_text("#bars")
        page.click('#bars >> text="Take them up again"')
        wait_unsaved(page, "1 unsaved pair")
        page.click("#save")
        wait_unsaved(page, "All saved")
    assert set(load_set(small).bigrams["f", "ah"].curves) == {"open"}


def test_a_file_changed_by_another_program_is_offered_for_reloading(
    page: Page, small: Path
) -> None:
    page.click('#poses button[aria-label="Remove FV"]')
    wait_unsaved(page, "1 unsaved pair")
    write_set(small, name="changed", rig="box.json")
    page.click("#save")
    page.click('#bars >> text="Reload, keep my edits"')
    until(page, "document.getElementById('set-name').textContent === 'changed'")
    page.click("#save")
    wait_unsaved(page, "All saved")
    assert load_set(small).name == "changed"
    assert set(load_set(small).bigrams["f", "ah"].curves) == {"open"}


def test_nothing_stands_out_of_the_window(page: Page) -> None:
    for width in (1300, 1000, 700, 400):
        page.set_viewport_size({"width": width, "height": 900})
        until(page, f"document.documentElement.scrollWidth <= {width}")
