"""The laboratories in Chromium and Firefox, from files, moved by pointer and keys. Skipped without a browser or ``make
page``; ``make test-page`` runs them all. No test depends on how long a run takes: it waits for the caption."""

import os
import random
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

import libcontact as ct

playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
ROOT = Path(__file__).resolve().parents[2]

import browser
import native

FOLDER = Path(os.environ.get("LIBCONTACT_BUILD", ROOT / "build")).resolve() / "page" / "html"
FOUND = {"chromium": browser.find(), "firefox": browser.find_firefox()}
NAMES = sorted(path.stem for path in FOLDER.glob("*.html") if path.stem != "index")
ACTIONS = int(os.environ.get("LIBCONTACT_PAGE_ACTIONS", "0"))  # of random input, by make test-page
pytestmark = pytest.mark.skipif(not NAMES, reason="no make page")
whole = pytest.mark.skipif(not ACTIONS, reason="part of make test-page")
FAST = {"bar": "cells=20", "plates": "n=20", "own": "example=bar_on_a_wall"}


class Engine:
    """A browser. Firefox has the colours and the motion that a reader prefers from its start on."""

    def __init__(self, driver, name, downloads):
        self.driver, self.name, self.downloads, self.started = driver, name, downloads, {}

    def context(self, width, scheme, motion, **more):
        """A window of a reader."""
        size = {"width": width, "height": 900}
        if self.name == "firefox":
            preferences = {
                "layout.css.prefers-color-scheme.content-override": int(scheme == "light"),
                "ui.prefersReducedMotion": int(motion == "reduce"),
            }
            own = self._start(scheme, motion, channel="moz-firefox", firefox_user_prefs=preferences)
            return own.new_context(
                viewport=size, color_scheme="null", reduced_motion="null", **more
            )
        own = self._start(args=["--no-sandbox"])
        return own.new_context(viewport=size, color_scheme=scheme, reduced_motion=motion, **more)

    def _start(self, *kind, **options):
        if kind not in self.started:
            start = getattr(self.driver, self.name).launch
            options |= {"executable_path": FOUND[self.name], "downloads_path": self.downloads}
            self.started[kind] = start(**options)
        return self.started[kind]


class Visit:
    """A page of its own context, what it asked for outside its files, and its errors."""

    def __init__(self, engine, width=1400, scheme="light", motion="no-preference", **more):
        self.engine, self.touch = engine, "tap" if more.get("has_touch") else "click"
        self.context = engine.context(width, scheme, motion, **more)
        self.page = self.context.new_page()
        self.page.set_default_timeout(120_000)
        self.outside, self.errors = [], []
        self.page.on("request", self._asked)
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on("console", self._said)

    def _asked(self, request):
        if not request.url.startswith(("file:", "blob:", "data:")):
            self.outside.append(request.url)

    def _said(self, message):
        if message.type in ("error", "warning"):
            self.errors.append(message.text)

    def open(self, name, state=""):
        state = state or FAST.get(name, "")
        self.goto(f"{(FOLDER / f'{name}.html').as_uri()}#{name}:{state}")
        return self.finished()

    def goto(self, address):
        """Load a page, also where a link that was hit has begun to load another one."""
        try:
            self.page.goto(address)
        except playwright.Error as error:
            if "interrupted by another navigation" not in str(error):
                raise
            self.page.wait_for_load_state()
            self.page.goto(address)

    def finished(self):
        """The caption of the run, when it is over."""
        rest = "() => !document.querySelector('[aria-busy]') && document.querySelector('.laboratory').laboratory.idle"
        self.page.wait_for_function(rest)
        return self.page.locator(".laboratory-caption").inner_text()

    def save(self, kind):
        """The path of a file that a button saves. Playwright does not see what Firefox loads down."""
        button = self.page.get_by_role("button", name=f"Save .{kind}")
        if self.engine.name != "firefox":
            with self.page.expect_download() as waiting:
                button.click()
            return waiting.value.path()
        path = self.engine.downloads / f"scene.{kind}"
        button.click()
        while not path.exists() or not path.stat().st_size or list(path.parent.glob("*.part")):
            self.page.wait_for_timeout(50)
        return path

    def end(self):
        self.context.close()
        assert not self.outside and not self.errors


@pytest.fixture(scope="module", params=FOUND)
def engine(request, tmp_path_factory):
    if FOUND[request.param] is None:
        pytest.skip(f"no {request.param}")
    if request.param == "firefox" and not ACTIONS:
        pytest.skip("Firefox is part of make test-page")
    with playwright.sync_playwright() as driver:
        own = Engine(driver, request.param, tmp_path_factory.mktemp("downloads"))
        yield own
        for each in own.started.values():
            each.close()


@pytest.fixture
def visit(engine):
    made = Visit(engine)
    yield made
    made.end()


@whole
@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [390, 1400])
@pytest.mark.parametrize("name", NAMES)
def test_a_laboratory_runs_from_its_file(engine, name, width, scheme):
    visit = Visit(engine, width, scheme)
    assert visit.open(name)
    page = visit.page
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    colour = page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert (sum(map(int, re.findall(r"\d+", colour)[:3])) < 200) == (scheme == "dark")
    for canvas in page.locator("canvas").all():
        assert canvas.get_attribute("aria-label")
        drawn = "c => new Set(c.getContext('2d').getImageData(0, 0, c.width, c.height).data).size"
        assert canvas.evaluate(drawn) > 2
    for control in page.locator(".laboratory-control :is(input, select)").all():
        label = page.locator(f"label[for={control.get_attribute('id')}]")
        assert label.inner_text().strip()
    visit.end()


@whole
@pytest.mark.parametrize("width", [390, 1400])
@pytest.mark.parametrize("name", NAMES)
def test_no_control_makes_the_layout_jump(engine, name, width):
    """The height of a laboratory, observed while each control takes its first and last value."""
    visit = Visit(engine, width)
    visit.open(name)
    page, laboratory = visit.page, "document.querySelector('.laboratory').laboratory"
    page.evaluate(
        "() => { window.heights = new Set(); const live = document.querySelector('.laboratory-live');"
        " new ResizeObserver(() => heights.add(live.offsetHeight)).observe(live); }"
    )
    for control in page.locator(".laboratory-control :is(input, select)").all():
        before = page.evaluate(
            f"Object.fromEntries(Object.keys({laboratory}.controls).map((name) => [name, {laboratory}.state[name]]))"
        )
        for key in ("Home", "End"):
            control.press(key)
            visit.finished()
        page.evaluate(f"before => {laboratory}.set(before)", before)
        visit.finished()
    assert len(page.evaluate("[...heights]")) == 1
    visit.end()


def small_plates(cells):
    """The text of a scene of two plates with the default law."""
    text = (
        ct.example("plates").read_text(encoding="utf-8").replace('"penalty"', '"energy_controlled"')
    )
    return text.replace("100, 1, 100", f"{cells}, 1, {cells}")


def energy(caption):
    return float(re.search(r"energy at the end is ([\d.]+) times", caption)[1])


def test_five_actions_show_the_growth_of_energy_and_then_the_default_s(visit):
    visit.open("bar", "x=")
    page = visit.page
    page.get_by_label("Law of the contact").select_option("penalty")
    page.get_by_label("Penalty factor").press("ArrowRight")
    grown = visit.finished()
    assert grown.startswith("Explicit penalty, β = 10,") and energy(grown) > 2.0
    page.get_by_label("Law of the contact").select_option("energy_controlled")
    kept = visit.finished()
    assert (
        kept.startswith("Energy-controlled penalty (the default), β = 10,")
        and 0.99 < energy(kept) <= 1.0
    )


def test_the_pointer_moves_a_slider_and_the_link_keeps_the_state(visit):
    visit.open("bar")
    page = visit.page
    slider = page.get_by_label("Landing phase")
    box = slider.bounding_box()
    page.mouse.move(box["x"] + 5, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] - 4, box["y"] + box["height"] / 2, steps=5)
    page.mouse.up()
    assert slider.get_attribute("aria-valuetext") == "0.9 h"
    before = visit.finished()
    address = page.locator(".laboratory-link").evaluate("link => link.href")
    assert address == page.url and "phase=0.9" in address
    page.goto("about:blank")
    page.goto(address)
    assert visit.finished() == before
    assert page.get_by_label("Landing phase").get_attribute("aria-valuetext") == "0.9 h"


def test_every_method_walks_step_by_step(engine):
    """By a finger: forward, back, played to its end, and by keys on the slider. Triangles of the simplex share two
    corners."""
    visit = Visit(engine, 390, **({"has_touch": True} if engine.name == "chromium" else {}))
    visit.open("closest", "steps=0")
    page = visit.page
    methods, steps = (
        page.get_by_role("combobox", name="Method"),
        page.get_by_role("slider", name="Step"),
    )

    def press(name):
        getattr(page.get_by_role("button", name=name), visit.touch)()

    def count():
        told = page.locator(".laboratory-verdict").inner_text()
        return tuple(map(int, re.search(r"step (\d+) of (\d+)", told).groups()))

    view = "document.querySelector('.laboratory').laboratory.view"
    page.evaluate(f"{view}.pace = 5")
    for method in methods.locator("option").all():
        methods.select_option(method.get_attribute("value"))
        visit.finished()
        steps.press("Home")
        step, most = count()
        assert step == 0 and most > 0, method.inner_text()
        press("Forward")
        assert count() == (1, most)
        steps.press("ArrowRight")
        assert count() == (min(2, most), most)
        press("Back")
        press("Play")
        page.wait_for_function(f"() => {view}.playing === null")
        assert count() == (most, most)
    methods.select_option("simplex")
    visit.finished()
    triangles = page.evaluate(f"{view}.now.part.triangles")
    shared = [sum(a == b for a in one for b in two) for one, two in zip(triangles, triangles[1:])]
    assert shared[:3] == [2, 2, 2]  # until it becomes smaller
    visit.end()


def test_a_finger_moves_a_node_or_scrolls_the_page(engine):
    if engine.name == "firefox":
        pytest.skip("Chromium alone takes the moves of a finger from playwright")
    visit = Visit(engine, 390, has_touch=True)
    visit.open("closest")
    page, view = visit.page, "document.querySelector('.laboratory').laboratory.view"
    finger = visit.context.new_cdp_session(page)

    def swipe(x, y, dx, dy):
        steps = [(x + dx * i / 10, y + dy * i / 10) for i in range(11)]
        for i, (a, b) in enumerate(steps):
            kind = "touchMove" if i else "touchStart"
            finger.send(
                "Input.dispatchTouchEvent", {"type": kind, "touchPoints": [{"x": a, "y": b}]}
            )
        finger.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
        page.wait_for_timeout(200)  # the page scrolls on by itself

    def now():
        box = page.get_by_role("application").bounding_box()
        point = page.evaluate(f"{view}.onScreen({view}.placeOf(8))")
        azimuth = page.evaluate(f"{view}.turn.azimuth")
        return page.evaluate("scrollY"), azimuth, point, (box["x"], box["y"])

    _, _, point, at = now()
    swipe(at[0] + point[0], at[1] + point[1], 0, 40)
    scrolled, azimuth, moved, at = now()
    assert scrolled == 0 and moved == pytest.approx([point[0], point[1] + 40], abs=0.5)
    swipe(at[0] + 20, at[1] + 300, 60, 5)
    scrolled, turned, _, at = now()
    assert scrolled == 0 and turned < azimuth - 0.2
    swipe(at[0] + 20, at[1] + 300, 5, -150)
    assert now()[0] > 50
    visit.end()


def test_nodes_and_point_move_by_pointer_and_keys(visit):
    visit.open("closest", "kind=Q4")
    page = visit.page
    state = "document.querySelector('.laboratory').laboratory.state"
    canvas = page.get_by_role("application")
    canvas.scroll_into_view_if_needed()
    box, before = canvas.bounding_box(), page.evaluate(f"{state}.nodes")
    place = "(v => v.onScreen(v.placeOf(2)))(document.querySelector('.laboratory').laboratory.view)"
    at = page.evaluate(place)
    page.mouse.move(box["x"] + at[0], box["y"] + at[1])
    page.mouse.down()
    page.mouse.move(box["x"] + at[0] + 40, box["y"] + at[1] + 10, steps=4)
    page.mouse.up()
    visit.finished()
    after = page.evaluate(f"{state}.nodes")
    moved = [i for i in range(9) if before[3 * i : 3 * i + 3] != after[3 * i : 3 * i + 3]]
    assert moved == [2]
    assert page.evaluate(place) == pytest.approx([at[0] + 40, at[1] + 10], abs=0.5)
    canvas.press("n")
    for _ in range(7):
        canvas.press("n")
    for key in ("w", "e", "ArrowLeft"):
        canvas.press(key)
    visit.finished()
    last, address = page.evaluate(f"{state}.nodes"), page.url
    assert last != after
    page.goto("about:blank")
    page.goto(address)
    visit.finished()
    assert page.evaluate(f"{state}.nodes") == last
    assert page.locator(".laboratory-table tbody tr").count() == 12
    page.locator("canvas[role=img]").click(position={"x": 150, "y": 150})
    visit.finished()
    assert page.evaluate(f"[{state}.start1, {state}.start2]") == [0, 0]


def test_a_scene_is_edited_checked_run_turned_and_saved(visit, tmp_path):
    meshio = pytest.importorskip("meshio")
    text = small_plates(6)
    text = text.replace('element = "hex8"', 'element = "hex20"', 1)
    text += '[[probe]]\nname = "at the wall"\nbody = "right"\npoint = [0, 0, 0]\n'
    (tmp_path / "plates.toml").write_text(text, encoding="utf-8")
    expected = ct.Scene.load(tmp_path / "plates.toml").run(output=False)
    visit.open("own")
    page, area = visit.page, visit.page.get_by_label("Scene (TOML)")
    area.fill(text.replace("beta = 4", "betta = 4"))
    told = page.locator(".laboratory-verdict").inner_text()
    assert re.match(r'line 2\d: contact\[0\].betta: unknown key; did you mean "beta"\?', told)
    area.fill(text)
    area.press("Control+Enter")
    visit.finished()
    mesh = meshio.read(visit.save("vtu"), file_format="vtu")
    states = [expected.state[name] for name in ("left", "right")]
    for name in ("displacement", "velocity"):
        rows = np.concatenate([getattr(state, name) for state in states])
        assert np.array_equal(mesh.point_data[name], rows)
    assert [block.type for block in mesh.cells] == ["hexahedron20", "hexahedron"]
    assert np.array_equal(
        np.concatenate(mesh.cell_data["stress"]), np.concatenate([s.stress for s in states])
    )
    ledger, probe = visit.save("csv").read_text(encoding="utf-8").split("\n\n")
    last = dict(
        zip(*(line.split(",") for line in (ledger.splitlines()[0], ledger.splitlines()[-1])))
    )
    assert float(last["total"]) == expected.energy["total"][-1]
    rows = np.loadtxt(probe.splitlines()[2:], delimiter=",")
    assert probe.startswith('# "at the wall"')
    history = expected.probes["at the wall"]
    assert np.array_equal(rows[:, 1:4], history["displacement"])
    canvas = page.get_by_role("application")
    canvas.scroll_into_view_if_needed()
    azimuth = "document.querySelector('.laboratory').laboratory.view.turn.azimuth"
    before = page.evaluate(azimuth)
    box = canvas.bounding_box()
    page.mouse.move(box["x"] + 100, box["y"] + 100)
    page.mouse.down()
    page.mouse.move(box["x"] + 160, box["y"] + 120, steps=3)
    page.mouse.up()
    assert page.evaluate(azimuth) == pytest.approx(before - 60 / 150)
    address = page.url
    page.goto("about:blank")
    page.goto(address)
    assert area.input_value() == text
    visit.finished()
    page.get_by_label("Begin with").select_option("bar_on_a_wall")
    visit.finished()
    assert 'name = "bar"' in area.input_value() and "text" not in page.url


def test_a_state_that_is_not_allowed_is_not_taken(visit):
    visit.open("bar", "law=<img src=x onerror=alert(1)>&beta=7&cells=1e9&phase=NaN&__proto__=1")
    page = visit.page
    assert page.locator("img").count() == 0
    state = page.evaluate("document.querySelector('.laboratory').laboratory.state")
    assert state == {
        **{"law": "energy_controlled", "beta": 5, "step": 0.9, "integrator": "central_difference"},
        **{"cells": 100, "phase": 0},
    }


def test_stop_ends_a_long_run_and_leaving_ends_the_worker(visit):
    visit.open("plates")
    page = visit.page
    page.evaluate("location.hash = '#plates:n=100&courant=0.05&end=1.1'")
    page.get_by_role("button", name="Stop").click()
    page.wait_for_function("() => document.querySelector('.laboratory').laboratory.idle")
    assert page.locator(".laboratory-status").inner_text() == "stopped"
    page.evaluate("dispatchEvent(new Event('pagehide'))")
    assert page.evaluate("document.querySelector('.laboratory').laboratory.remote.worker === null")
    page.get_by_label("Elements along d").press("Home")
    assert visit.finished()


def test_the_browser_has_the_bits_of_this_machine(visit):
    tasks, found = native.hashes()
    task, exact = native.closed_form()
    visit.open("own")
    visit.page.add_script_tag(path=ROOT / "tests" / "page" / "tasks.js")
    *hashes, form = visit.page.evaluate("tasks => answersOf(tasks)", [*tasks, task])
    assert hashes == found
    assert np.abs(np.reshape(form, (-1, 5)).T - exact).max() < 1e-12


def test_without_motion_only_the_end_is_shown(engine):
    visit = Visit(engine, motion="reduce")
    visit.open("plates", "n=10")
    page = visit.page
    page.evaluate(
        "() => { const view = document.querySelector('.laboratory').laboratory.view, old = view.show;"
        " window.shown = []; view.show = (part, state) => { shown.push(part.fraction); old.call(view, part, state); }; }"
    )
    page.get_by_role("button", name="Run").click()
    visit.finished()
    assert page.evaluate("shown") == [1]
    visit.end()


def test_a_copied_folder_runs(visit, tmp_path):
    """As on a memory stick: from the first page to each laboratory and back."""
    folder = tmp_path / "a stick with blanks, é & #"
    shutil.copytree(FOLDER, folder)
    page = visit.page
    visit.goto((folder / "index.html").as_uri())
    links = page.locator("li a")
    assert links.count() == len(NAMES)
    for i in range(len(NAMES)):
        links.nth(i).click()
        page.wait_for_load_state()
        assert visit.finished() and "failed" not in page.locator(".laboratory-status").inner_text()
        page.get_by_role("link", name="All laboratories").click()
        page.wait_for_load_state()


@pytest.mark.parametrize("name", NAMES)
def test_without_javascript_and_on_paper_a_page_has_its_picture(engine, name):
    """Firefox cannot be asked by playwright to be without JavaScript."""
    if engine.name == "firefox":
        pytest.skip("Chromium alone has the option")
    for more in ({"java_script_enabled": False}, {}):
        visit = Visit(engine, 390, **more)
        visit.goto((FOLDER / f"{name}.html").as_uri())
        drawing = (
            visit.page.get_by_role("img").locator("visible=true").and_(visit.page.locator("svg"))
        )
        if not more:
            visit.finished()
            assert not drawing.count()
            visit.page.emulate_media(media="print")
        box = drawing.bounding_box()
        assert box["width"] > 300 and box["height"] > 80 and box["x"] >= 0
        assert box["x"] + box["width"] <= 390
        assert visit.page.locator("figcaption").is_visible()
        visit.end()


@whole
@pytest.mark.parametrize("name", NAMES)
def test_random_input_leaves_a_page_that_runs(visit, name):
    random.seed(name)
    visit.open(name)
    page = visit.page
    controls = page.locator(".laboratory :is(input, select, button, canvas[tabindex])")
    keys = ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "Tab", "Home", "Enter"]
    for _ in range(ACTIONS):
        if not controls.count():  # the pointer was on a link
            visit.open(name)
        control = controls.nth(random.randrange(controls.count()))
        if control.is_enabled():
            control.focus()
        page.keyboard.press(random.choice(keys))
        if random.random() < 0.3:
            page.mouse.click(random.uniform(50, 1300), random.uniform(50, 850))
    visit.goto("about:blank")
    assert visit.open(name)
