"""The report in a real browser: no complaint, the tip where the result has it, time by slider, keys and clock, nothing too wide for a phone.

Needs selenium (extra "browser") and Chromium with its driver; skipped, with the reason, where one is missing.
"""

from __future__ import annotations

import base64
import io
import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from .scenes import heavy_top, long_named, main_job, slider_crank

webdriver = pytest.importorskip("selenium.webdriver", reason='selenium is not installed: pip install "mbd[test]"')

FLAGS = ("headless=new", "no-sandbox", "disable-gpu", "disable-background-networking", "disable-component-update", "disable-sync", "no-first-run")
DESKTOP, PHONE = (1280, 900), (390, 844)
TIMES = (0.0, 0.123456, 0.6, 0.9051, 1.2)
BROWSERS, DRIVERS = ("chromium", "chromium-browser", "google-chrome", "chrome"), ("chromedriver", "chromium-chromedriver")


def program(names: tuple[str, ...]) -> str:
    found = next((path for name in names if (path := shutil.which(name))), None)
    if not found:
        pytest.skip(f"none of {', '.join(names)} is on the path: install Chromium and its driver (apt-get install chromium chromium-driver)")
    return found


class Browser:
    """A window, and what the tests ask of it."""

    def __init__(self, profile: Path, size: tuple[int, int]):
        options = webdriver.ChromeOptions()
        options.binary_location = program(BROWSERS)
        for flag in (*FLAGS, f"user-data-dir={profile}", f"window-size={size[0]},{size[1]}"):
            options.add_argument(f"--{flag}")
        if size == PHONE:
            metrics = {"width": size[0], "height": size[1], "pixelRatio": 2.0, "touch": True}
            options.add_experimental_option("mobileEmulation", {"deviceMetrics": metrics})
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(program(DRIVERS)))
        self.driver.set_script_timeout(20)

    def open(self, page: Path) -> None:
        self.driver.get(page.as_uri())

    def do(self, script: str, *arguments: Any) -> Any:
        return self.driver.execute_script(script, *arguments)

    def key(self, name: str, target: str = "body", shift: bool = False) -> None:
        """A key pressed, as a browser tells it."""
        event = "new KeyboardEvent('keydown', {key: arguments[0], shiftKey: arguments[2], bubbles: true, cancelable: true})"
        self.do(f"document.querySelector(arguments[1]).dispatchEvent({event})", name, target, shift)

    def press(self, keys: str) -> None:
        """Keys typed by the driver, to whatever has the focus."""
        self.driver.switch_to.active_element.send_keys(keys)

    def time(self) -> float:
        return self.do("return mbdReport.time()")

    def tip(self, name: str = "rod.end") -> np.ndarray:
        return np.array(self.do("return mbdReport.screen(arguments[0])", name))

    def pixels(self) -> np.ndarray:
        """[height, width, 4] of the canvas."""
        pillow = pytest.importorskip("PIL.Image")
        data = self.do("return document.getElementById('stage').toDataURL('image/png')").partition(",")[2]
        return np.asarray(pillow.open(io.BytesIO(base64.b64decode(data))).convert("RGBA")).astype(int)

    def width(self) -> tuple[int, int]:
        """Of the document and of the window."""
        return self.do("return [document.documentElement.scrollWidth, document.documentElement.clientWidth]")


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("pages")
    _, text = main_job()
    (folder / "pendulum.html").write_text(text, encoding="utf-8")
    heavy_top().report(folder / "top.html", outputs={"top": heavy_top().scene["top"].at()})
    slider_crank().report(folder / "crank.html")
    long_named().report(folder / "names.html", outputs={"n" * 150: long_named().scene["b" * 150], "f" * 150: lambda run: run.q}, title="t" * 150)
    (folder / "notebook.html").write_text(f"<!DOCTYPE html><body>{slider_crank()._repr_html_()}</body>", encoding="utf-8")
    return {path.stem: path for path in folder.iterdir()}


def opened(size: tuple[int, int], folder: Path) -> Iterator[Browser]:
    browser = Browser(folder, size)
    try:
        yield browser
        complaints = browser.driver.get_log("browser")
        assert not complaints, complaints
    finally:
        browser.driver.quit()


@pytest.fixture(scope="module")
def desktop(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    yield from opened(DESKTOP, tmp_path_factory.mktemp("desktop"))


@pytest.fixture(scope="module")
def phone(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    yield from opened(PHONE, tmp_path_factory.mktemp("phone"))


@pytest.fixture
def page(desktop: Browser, pages: dict[str, Path]) -> Browser:
    """The main job, fresh."""
    desktop.open(pages["pendulum"])
    return desktop


def test_no_complaint_in_the_console(desktop, pages):
    for page in pages.values():
        desktop.open(page)
    assert not desktop.driver.get_log("browser")


@pytest.mark.parametrize("name", ["rod.end", "middle"])
def test_the_tip_is_where_the_result_has_it(page, name):
    """Both by what the page says and by the pixels it painted, at frames and between them."""
    run, _ = main_job()
    marker = run.scene["rod"].end if name == "rod.end" else run.scene["rod"].at(0.5)
    page.do("document.getElementById('trails').value = 'none'")
    camera = page.do("return mbdReport.camera()")
    for t in TIMES:
        page.do("mbdReport.seek(arguments[0])", t)
        x, y = run.position(marker, t=t) - camera["origin"]
        expected = (camera["width"] / 2 + camera["scale"] * (x - camera["u"]), camera["height"] / 2 - camera["scale"] * (y - camera["v"]))
        assert np.max(np.abs(page.tip(name) - expected)) < 0.5, t
        if name == "rod.end":
            painted = np.argwhere((np.abs(page.pixels()[..., :3] - (213, 94, 0)) < 12).all(axis=-1))  # vermillion: nothing else is
            assert np.max(np.abs(painted.mean(axis=0)[::-1] + 0.5 - expected)) < 1.0, t


def test_the_rod_is_painted_along_its_points(page):
    """Blue pixels at points of the rod that are no outputs, and to equal scales."""
    run, _ = main_job()
    page.do("mbdReport.seek(0.8)")
    pixels = page.pixels()
    for s in (0.2, 0.35, 0.7, 0.85):
        x, y = np.floor(page.do("return mbdReport.project(arguments[0])", run.position(run.scene["rod"].at(s), t=0.8).tolist())).astype(int)
        assert np.abs(pixels[y - 1 : y + 2, x - 1 : x + 2, :3] - (0, 114, 178)).max(axis=-1).min() < 12, s
    a, b, c = (np.array(page.do("return mbdReport.project(arguments[0])", place)) for place in ((0, 0), (1, 0), (0, 1)))
    np.testing.assert_allclose(b - a, (a - c)[::-1], atol=1e-9)


def test_the_slider_moves_time(page):
    page.do("const s = document.getElementById('slider'); s.value = 0.75; s.dispatchEvent(new Event('input'))")
    assert page.time() == pytest.approx(0.75) and "0.750 s" in page.do("return document.getElementById('clock').textContent")
    assert page.do("return document.getElementById('slider').getAttribute('aria-valuetext')") == "0.750 s"
    page.do("document.getElementById('slider').focus()")
    page.press("\ue012")  # arrow left: a frame back, by the driver's own keyboard
    assert page.time() == pytest.approx(0.75 - 1.2 / (page.do("return mbdReport.frames") - 1), abs=1e-9)


def test_keys_move_time(page):
    frame = 1.2 / (page.do("return mbdReport.frames") - 1)
    for key, expected in (("End", 1.2), ("ArrowLeft", 1.2 - frame), ("Home", 0.0), ("ArrowRight", frame), ("ArrowRight", 2 * frame)):
        page.key(key)
        assert page.time() == pytest.approx(expected, abs=1e-9), key
    page.key("PageUp", "#stage")
    assert page.time() == pytest.approx(12 * frame, abs=1e-9)
    page.key(" ")
    assert page.do("return mbdReport.playing()")
    page.key(" ")
    assert not page.do("return mbdReport.playing()")


def test_playing_advances_at_the_chosen_speed(page):
    """Against the browser's own clock; the end is looped past."""
    watch = """
        const done = arguments[arguments.length - 1], speed = document.getElementById('speed');
        speed.value = '0.2'; document.getElementById('play').click();
        const start = performance.now();
        setTimeout(() => done([mbdReport.time(), (performance.now() - start) / 1000, mbdReport.playing()]), 1200);
    """
    t, passed, playing = page.driver.execute_async_script(watch)
    assert playing and 0.5 * 0.2 * passed < t < 1.1 * 0.2 * passed
    loop = "const done = arguments[0]; mbdReport.seek(1.19); setTimeout(() => done(mbdReport.time()), 700)"
    assert page.driver.execute_async_script(loop) < 0.5
    stop = "const done = arguments[0]; document.getElementById('loop').click(); mbdReport.seek(1.19); setTimeout(() => done(mbdReport.time()), 700)"
    assert page.driver.execute_async_script(stop) == pytest.approx(1.2) and not page.do("return mbdReport.playing()")


def test_the_cursor_of_plots_follows_and_leads(page):
    page.do("mbdReport.seek(0.6)")
    where = "const c = document.querySelector('.plot .cursor').getBoundingClientRect(); return c.left + c.width / 2"
    frame = page.do("const f = document.querySelector('.plot .frame').getBoundingClientRect(); return [f.left, f.right, f.top]")
    assert page.do(where) == pytest.approx(0.5 * (frame[0] + frame[1]), abs=1.5)
    click = "new PointerEvent('pointerdown', {clientX: arguments[0], clientY: arguments[1], bubbles: true})"
    page.do(f"document.querySelector('.plot svg[role=img]').dispatchEvent({click})", frame[0] + 0.25 * (frame[1] - frame[0]), frame[2] + 20)
    assert page.time() == pytest.approx(0.3, abs=0.01)


def test_values_at_the_cursor_are_those_of_the_result(page):
    run, _ = main_job()
    page.do("mbdReport.seek(0.6)")
    values = page.do("return [...document.querySelectorAll('.plot')][0].querySelectorAll('.value').length")
    assert values == 4
    kinetic = page.do("return document.querySelector('.plot .value').textContent")
    _, v = run.trajectory.at(np.array(0.6))
    assert float(kinetic) == pytest.approx(float(run.system.kinetic(v)), rel=1e-3)


def test_curves_can_be_hidden(page):
    count = "return document.querySelectorAll('.plot')[0].querySelectorAll('.curve').length"
    before = page.do(count)
    page.do("document.querySelector('.plot .legend button').click()")
    assert page.do(count) == before - 1
    assert page.do("return document.querySelector('.plot .legend button').getAttribute('aria-pressed')") == "false"


def test_the_camera_zooms_pans_and_fits(page):
    start = page.do("return mbdReport.camera()")
    page.do("document.getElementById('closer').click()")
    assert page.do("return mbdReport.camera().scale") == pytest.approx(1.25 * start["scale"])
    before = page.tip()
    drag = """
        const stage = document.getElementById('stage'), box = stage.getBoundingClientRect();
        for (const [type, x, y] of [['pointerdown', 200, 150], ['pointermove', 230, 170], ['pointerup', 230, 170]])
          stage.dispatchEvent(new PointerEvent(type, {pointerId: 1, clientX: box.left + x, clientY: box.top + y, bubbles: true}));
    """
    page.do(drag)
    np.testing.assert_allclose(page.tip() - before, (30, 20), atol=1e-6)
    page.key("f")
    assert page.do("return mbdReport.camera().scale") == pytest.approx(start["scale"])


def test_pinching_zooms_about_the_fingers(page):
    pinch = """
        const stage = document.getElementById('stage'), box = stage.getBoundingClientRect();
        const send = (type, id, x) => stage.dispatchEvent(
          new PointerEvent(type, {pointerId: id, pointerType: 'touch', clientX: box.left + x, clientY: box.top + 200, bubbles: true}));
        send('pointerdown', 1, 300); send('pointerdown', 2, 400); send('pointermove', 2, 500); send('pointerup', 1, 300); send('pointerup', 2, 500);
    """
    scale = page.do("return mbdReport.camera().scale")
    page.do(pinch)
    assert page.do("return mbdReport.camera().scale") == pytest.approx(2.0 * scale)


def test_space_is_seen_from_all_sides(desktop, pages):
    desktop.open(pages["top"])
    run = heavy_top()
    camera = desktop.do("return mbdReport.camera()")
    a, e = camera["azimuth"], camera["elevation"]
    for t in (0.0, 0.07, 0.2):
        desktop.do("mbdReport.seek(arguments[0])", t)
        x, y, z = run.position(run.scene["top"].at(), t=t) - camera["origin"]
        u = -np.sin(a) * x + np.cos(a) * y
        v = -np.cos(a) * np.sin(e) * x - np.sin(a) * np.sin(e) * y + np.cos(e) * z
        expected = (camera["width"] / 2 + camera["scale"] * (u - camera["u"]), camera["height"] / 2 - camera["scale"] * (v - camera["v"]))
        assert np.max(np.abs(desktop.tip("top") - expected)) < 0.5
    desktop.key("ArrowLeft", "#stage", shift=True)
    assert desktop.do("return mbdReport.camera().azimuth") == pytest.approx(a - 0.2)


def test_a_notebook_plays_it_in_a_frame(desktop, pages):
    """The frame's page has no access to what is around it, and works."""
    desktop.open(pages["notebook"])
    frame = desktop.driver.find_element("tag name", "iframe")
    assert frame.get_attribute("sandbox") == "allow-scripts"
    desktop.driver.switch_to.frame(frame)
    try:
        desktop.do("mbdReport.seek(0.1)")
        assert desktop.time() == pytest.approx(0.1)
    finally:
        desktop.driver.switch_to.default_content()


def test_print_shows_a_picture_plots_and_every_section(page):
    page.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    try:
        page.do("window.dispatchEvent(new Event('beforeprint'))")
        shown = "return getComputedStyle(document.querySelector(arguments[0])).display"
        assert [page.do(shown, place) for place in (".film", ".still")] == ["none", "block"]
        closed = "return document.querySelectorAll('details:not([open])').length"
        assert page.do(closed) == 0
        assert page.do("return document.querySelector('.still svg').getBoundingClientRect().width") > 300
        page.do("window.dispatchEvent(new Event('afterprint'))")
        assert page.do(closed) == 3  # the table of items, the scene file and the reproduction
    finally:
        page.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})


def test_dark_is_readable(page):
    page.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": "dark"}]})
    try:
        page.driver.execute_async_script("requestAnimationFrame(() => requestAnimationFrame(arguments[0]))")
        assert page.pixels()[5, 200, :3].max() < 60 and page.do("return getComputedStyle(document.body).color") == "rgb(236, 236, 236)"
    finally:
        page.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})


@pytest.mark.parametrize("name", ["pendulum", "top", "crank", "names"])
def test_a_phone_shows_it_without_scrolling_aside(phone, pages, name):
    phone.open(pages[name])
    document, window = phone.width()
    assert document <= window <= 390
    small = "return [...document.querySelectorAll('.controls button, .camera button')].filter(b => b.getBoundingClientRect().height < 28).length"
    assert phone.do(small) == 0
    phone.do("mbdReport.seek(0.1)")
    assert phone.time() == pytest.approx(0.1)


def test_texts_of_the_page_do_not_overlap(page):
    """Boxes of the labels of each plot's axes, and of what lies over the stage."""
    overlaps = """
        const hit = (a, b) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 3 && b.top < a.bottom - 3;
        const groups = [...document.querySelectorAll('.plot svg[role=img]')].map(s => [...s.querySelectorAll('text')]);
        groups.push([...document.querySelectorAll('#clock, #followed li, .camera button')]);
        return groups.flatMap(g => { const boxes = g.map(e => e.getBoundingClientRect());
          return boxes.flatMap((a, i) => boxes.slice(i + 1).filter(b => hit(a, b)).map(() => g[i].textContent)); });
    """
    assert page.do(overlaps) == []


@pytest.mark.skipif("MBD_SCREENSHOTS" not in os.environ, reason="set MBD_SCREENSHOTS=docs/screenshots to take the pictures of the guide anew")
def test_screenshots(desktop, phone, pages):
    folder = Path(os.environ["MBD_SCREENSHOTS"])
    folder.mkdir(parents=True, exist_ok=True)
    for name, browser, page, t, top in (
        ("report-desktop", desktop, "pendulum", 0.84, "header"),
        ("report-phone", phone, "pendulum", 0.84, "header"),
        ("report-space", desktop, "top", 0.15, "header"),
        ("report-crank", desktop, "crank", 0.15, "header"),
        ("report-plots", desktop, "pendulum", 0.84, "#plots"),
    ):
        browser.open(pages[page])
        browser.do("document.getElementById('ghosts').click(); mbdReport.seek(arguments[0])", t)
        browser.do("document.querySelector(arguments[0]).scrollIntoView()", top)
        browser.driver.execute_async_script("requestAnimationFrame(() => requestAnimationFrame(arguments[0]))")
        browser.driver.save_screenshot(str(folder / f"{name}.png"))
        assert (folder / f"{name}.png").stat().st_size < 300_000
