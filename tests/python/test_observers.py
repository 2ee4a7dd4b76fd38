"""Observers of a run: a user's functions, when they are called, and that they change nothing."""

import numpy as np
import pytest
from libcontact.checks.warned import during
from libcontact.observers import Observer
from scenes import box_of, same_state, scene_with

from libcontact import loop


def bars(contact=True):
    """Two bars that meet."""
    scene = scene_with("soft", young=2.0, poisson=0.3, density=1.5, title="bars")
    for name, x, v in (("left", -2.0, 0.1), ("right", 0.01, -0.1)):
        box = box_of([x, 0, 0], [2, 1, 1], [8, 2, 2])
        scene.add_body(name, material="soft", box=box, velocity=[v, 0, 0])
    if contact:
        scene.add_contact("left.x_max", "right.x_min")
    return scene.set_time(end=3.0, fraction=0.5)


def run(scene, *observers, **options):
    return scene.run(output=False, observers=observers, **options)


def test_when_they_are_called_and_that_the_bits_stay():
    seen, rare = [], []
    plain = run(bars())
    watched = run(bars(), (seen.append, 7), (lambda state: rare.append(state.step), 10**6))
    last = plain.state.step
    assert [state.step for state in seen] == sorted({*range(0, last + 1, 7), last})
    assert rare == [0, last]
    for name in ("left", "right"):
        assert np.array_equal(seen[-1][name].velocity, plain.state[name].velocity)
    assert same_state(plain, watched)
    assert np.array_equal(plain.energy["total"], watched.energy["total"])


def test_they_may_end_a_run():
    def stop(state):
        if state.time > 1.0:
            raise StopIteration(state.step)

    with pytest.raises(StopIteration):
        run(bars(), (stop, 5))


def test_a_divided_step_keeps_their_times():
    problem = bars()._built(1)
    finer = bars()._built(1, problem.dt / 2)
    seen = []
    made = loop.Loop(problem, "", observers=[(seen.append, 6)], built=lambda dt: finer)
    assert all(isinstance(each, Observer) for each in made.observers)
    before = [each.every for each in made.observers]
    assert before[-1] == 6 and made._divide(2)
    assert [each.every for each in made.observers] == [2 * every for every in before]


def test_a_scene_without_contacts_is_cut_only_to_look_at_its_volumes():
    assert [each.next(5) for each in during(bars(contact=False)._built(1))] == [
        np.inf,
        64,
        np.inf,
        np.inf,
    ]


@pytest.mark.parametrize(
    ("wrong", "kind", "text"),
    [
        (print, TypeError, "a pair of a function"),
        ((print,), TypeError, "a pair of a function"),
        (("often", 3), TypeError, "a pair of a function"),
        ((print, 0), ValueError, "must be 1 or more, not 0"),
        ((print, 1.5), TypeError, "observers"),
    ],
)
def test_refusals(wrong, kind, text):
    with pytest.raises(kind, match=text):
        run(bars(), wrong)
