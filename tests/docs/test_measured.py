"""Numbers in the text: the role reads them from a file and fails the build for unknown ones; the file has the present
results of the library."""

import json
import math
import re
from pathlib import Path

import books
import measure
import pytest
from measures import penalty

ROOT = Path(__file__).resolve().parents[2]


FILE = json.loads(measure.FILE.read_text())
ROLE = re.compile(r":measured:`([\w.]+):([^`]+)`")
PAGES = {
    page: page.read_text()
    for page in (ROOT / "docs").rglob("*.rst")
    if "tutorials" not in page.parts
}


def test_pages_and_file_name_the_same_numbers():
    """No page asks for a number that the file lacks (the build would fail, too), and the file has none that no page
    shows."""
    asked = {name for text in PAGES.values() for name, _ in ROLE.findall(text)}
    held = {f"{group}.{key}" for group, numbers in FILE.items() for key in numbers}
    assert asked and asked == held


@pytest.mark.parametrize("name", sorted(set(measure.MEASUREMENTS) - measure.SLOW))
def test_the_file_holds_what_is_computed(name, monkeypatch):
    """To a per mille, so that a digit which depends on the machine does not matter; and none that is round-off."""
    monkeypatch.chdir(ROOT)
    found = measure.rounded(measure.MEASUREMENTS[name]())
    assert found.keys() == FILE[name].keys()
    assert {
        key: value
        for key, value in found.items()
        if not math.isclose(value, FILE[name][key], rel_tol=1e-3, abs_tol=1e-9)
    } == {}


def test_closed_forms():
    """Measured numbers compared with the formulas that their pages derive."""
    courant = {Q1: 1 / (3 * Q1 + math.sqrt(9 * Q1**2 + 1)) for Q1 in (0.0, 0.06, 0.12, 0.5)}
    assert [
        FILE["viscosity"][name]
        for name in ("courant_0", "courant_006", "courant_both", "courant_05")
    ] == pytest.approx(list(courant.values()), rel=1e-4)
    assert FILE["absorb"]["open"] == pytest.approx((math.sqrt(5) - 1) / 2, rel=1e-4) and FILE[
        "absorb"
    ]["closed"] == pytest.approx(1, rel=1e-4)
    assert FILE["first_run"]["plateau"] == pytest.approx(FILE["first_run"]["exact"], rel=2e-3)
    assert [FILE["one_blow"][name] for name in ("entry_3", "entry_9")] == pytest.approx(
        [2 / 3 * 0.3**2, 2 / 3 * 0.9**2], rel=1e-4
    )


def test_growth_depends_on_the_landing():
    """Two landings of the many that the slow measurements take lie within the range that the page gives, far from each
    other."""
    found = sorted(one["most"] for one in penalty.explicit_bar(10.0, landings=2))
    assert (
        FILE["integrator"]["leapfrog_least"] <= found[0] < 1.5
        and 3 < found[1] <= FILE["integrator"]["leapfrog_most"]
    )
    assert FILE["integrator"]["leapfrog_growth"] == pytest.approx(
        FILE["integrator"]["leapfrog_most"] - 1, rel=1e-4
    )


# The role, on books of one page.


def build(tmp_path, text, numbers='{"bar": {"length": 0.61803, "tiny": 1.2e-05, "fall": -46.957}}'):
    conf, page = "extensions = ['measured']\n", f"Page\n====\n\n{text}\n"
    books.write(tmp_path, {"conf.py": conf, "index.rst": page, "measured.json": numbers})
    pytest.importorskip("sphinx")
    done, out = (
        books.build(tmp_path, "-W", "--keep-going", "-q", builder="text"),
        tmp_path / "out/index.txt",
    )
    return done, out.read_text() if out.exists() else ""


def test_role_writes_the_number_in_its_format(tmp_path):
    done, page = build(
        tmp_path,
        "It is :measured:`bar.length:.3f`, :measured:`bar.length:.1%`, :measured:`bar.tiny:.1e`, :measured:`bar.fall:.2f`.",
    )
    assert done.returncode == 0, done.stderr
    assert "It is 0.618, 61.8\N{NO-BREAK SPACE}%, 1.2·10⁻⁵, −46.96." in page


def test_build_fails_for_what_is_not_there(tmp_path):
    roles = {
        "bar.width:.3f": "has no number bar.width",
        "foo.length:.3f": "has no number foo.length",
        "bar:.3f": "has no number bar",
        "bar.length:.3q": "format",
    }
    done, _ = build(tmp_path, "\n".join(f":measured:`{role}`" for role in roles))
    assert done.returncode != 0
    for reason in roles.values():
        assert re.search(
            rf"index\.rst:\d+: WARNING: measured: .*{re.escape(reason)}", done.stderr
        ), done.stderr


def test_build_fails_without_the_file(tmp_path):
    done, _ = build(tmp_path, "It is :measured:`bar.length:.3f`.", numbers="{}")
    assert done.returncode != 0 and "has no number bar.length" in done.stderr
