"""Part I of the book: what its chapters say about their programs."""

import contextlib
import io
import runpy
from pathlib import Path

import bar
import numpy as np
import plates
import pytest
import wall

import libcontact as ct

WEEK = Path(__file__).resolve().parents[2] / "docs" / "week"


@pytest.mark.parametrize("name", ["wall", "bar", "plates"])
def test_a_program_prints_what_the_page_shows(name):
    with contextlib.redirect_stdout(io.StringIO()) as told:
        runpy.run_path(str(WEEK / f"{name}.py"), run_name="__main__")
    assert told.getvalue() == (WEEK / f"{name}.out").read_text(encoding="utf-8")


def test_small_steps_follow_the_sine():
    """eq:week-leapfrog, eq:week-penalty, against eq:week-by-hand."""
    dt = 1e-4
    gaps, velocities = wall.bounce(100.0, dt, gap=0.2)
    t = dt * np.arange(len(gaps)) - 0.2
    inside = (t > 0) & (t < np.pi / 10)
    assert np.abs(gaps + np.sin(10 * t) / 10)[inside].max() < 1e-4
    assert abs(velocities[-1] - 1) < 1e-4


def test_the_ramp_never_gains_and_the_penalty_does():
    """eq:week-ramp and eq:week-penalty."""
    rng = np.random.default_rng(5)
    for step in rng.uniform(0.01, 6.0, 40):
        assert wall.rebound(step, controlled=True, samples=20).max() <= 1 + 1e-12
    assert wall.rebound(1.5).max() > 1.2
    with np.errstate(all="ignore"):
        assert wall.bounce(100.0, 0.25)[1][-1] == pytest.approx(5.25)


def test_the_longest_step_is_exact_in_a_bar():
    """eq:week-element, eq:week-courant, against eq:week-impact-stress."""
    times, stresses, forces, _ = bar.impact(penalty=1e12, travel=1.9)
    assert np.abs(forces[1:] - 1).max() < 1e-9
    x = np.delete(np.arange(201), 100)
    front = np.minimum(times, 2 - times)[:, None] * 100
    place = np.where(np.arange(200) < 100, 99 - np.arange(200), np.arange(200) - 100)
    behind = place[None, :] + 1 < front + 0.5
    shown = stresses[:, x]
    assert np.abs(shown + behind).max() < 1e-9


def test_the_bars_contact_adds_no_energy():
    """eq:week-two: the first force by hand, from W = 4 Δt²/h; and with another W the work does not balance."""
    rng = np.random.default_rng(7)
    for _ in range(6):
        courant, penalty = rng.uniform(0.1, 0.98), 10 ** rng.uniform(1, 6)
        elements = int(rng.integers(5, 60))
        *_, forces, v = bar.impact(elements, courant, 3.0, penalty)
        dt = courant / elements
        by_hand = 2 * dt / (2 / penalty + 4 * dt**2 * elements)
        assert forces[0] == pytest.approx(by_hand, rel=1e-12)
        mass = np.full(len(v), 1.0 / elements)
        mass[[0, elements, elements + 1, -1]] /= 2
        assert 0.5 * mass @ v**2 <= 1 + 1e-12
        assert abs(mass @ v) < 1e-13


def test_the_plain_penalty_shortens_the_step():
    _, stresses, _, _ = bar.impact(courant=0.9, controlled=False)
    assert stresses.min() < -100
    with np.errstate(all="ignore"):
        blown = plates.centre_stress(plates.impact(100, courant=0.7)[1], 100)
        held = plates.centre_stress(plates.impact(100, courant=0.7, wall=True)[1], 100)
    assert np.abs(blown[:4, 0, 0]).max() > 10 * 7 / 3
    assert np.abs(held).max() < 1.5 * 7 / 3


def test_strains_of_a_bilinear_motion():
    """eq:week-b: of u = (ξη, 3ξη) in a square of edge h, where ∂ξ/∂x = 2/h."""
    xi, eta, h = 0.3, -0.7, 0.5
    u = np.outer(plates.CORNERS.prod(axis=1), [1, 3]).ravel()
    strain = np.array([eta, 3 * xi, 3 * eta + xi]) * 2 / h
    assert plates.strain_matrix(xi, eta, h) @ u == pytest.approx(strain)


@pytest.mark.parametrize(
    ("scene", "wall", "agree"), [("plates_reference", True, 1e-12), ("plates", False, 1e-7)]
)
@pytest.mark.parametrize("cells", [20, 35])
def test_the_readers_plates_are_the_librarys(scene, wall, agree, cells):
    """eq:week-hooke, eq:week-b, eq:week-potential: stresses of another program."""
    data = ct.Scene.load(ct.example(scene)).data
    for body in data["body"]:
        body["box"]["cells"], body["box"]["size"][1] = [cells, 1, cells], plates.D / cells
    body = ct.Scene(data).run(output=False).state["right"]
    order = np.lexsort((body.centres[:, 2].round(9), body.centres[:, 0].round(9)))
    theirs = body.stress[order].reshape(cells, cells, 6)[:, :, [0, 2, 5]]
    own = plates.centre_stress(plates.impact(cells, wall=wall)[1], cells)
    off = own - theirs * plates.C1 / (plates.LAMBDA * plates.SPEED)
    assert np.abs(off).max() < agree


def test_the_ramp_is_the_spring_at_the_mean_gap():
    """eq:week-ramp: with the gap that the force leads to, it is half the spring's force at both gaps, eq:week-mean."""
    for free, before, W, k in (
        (-0.3, -0.1, 0.2, 7.0),
        (-0.2, 0.4, 0.5, 3.0),
        (0.1, -0.05, 0.1, 9.0),
    ):
        force = wall.ramp(free, before, W, k)
        after = free + W * force
        assert force == pytest.approx(0.5 * k * max(0.0, -after - min(before, 0.0)), rel=1e-13)
