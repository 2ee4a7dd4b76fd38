"""Answers of the exercises of the chapter on the forces of a step."""

import numpy as np

W = np.array([[2.0, 1.0], [1.0, 2.0]])


def solved(g):
    """The least of F among all choices of points that press."""
    best = np.zeros(2)
    for active in ([0], [1], [0, 1]):
        force = np.zeros(2)
        force[active] = np.linalg.solve(W[np.ix_(active, active)], -g[active])
        if (
            force >= 0
        ).all() and force @ W @ force / 2 + force @ g < best @ W @ best / 2 + best @ g:
            best = force
    return best


def test_constraint_two(says):
    assert solved(np.array([-3.0, -3.0])).tolist() == [1, 1]
    force = solved(np.array([-3.0, -1.0]))
    assert np.allclose(np.linalg.solve(W, [3, 1]), [5 / 3, -1 / 3])
    says(f"{force[0]:.1f}", f"{(W @ force)[1] - 1:.1f}", "5/3", "-1/3", "1/3")


def test_constraint_rounds(says):
    g, force, rounds = np.array([-3.0, -1.0]), np.zeros(2), []
    while abs(force[0] - 1.5) > 1.5e-4:
        force = force - np.minimum((W @ force + g) / 3, force)
        rounds.append(force)
    says(
        f"{rounds[1][0]:.3f}", f"{rounds[1][1]:.3f}", f"{rounds[2][0]:.3f}", str(len(rounds)), "1/3"
    )
