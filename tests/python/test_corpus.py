"""Each method on the corpus of hard cases, compared with results that were computed without the library."""

import numpy as np
import pytest

import libcontact as ct

pytest.importorskip("mpmath")

import corpus

CASES = corpus.load()
RIGHT = 1e-6  # of the distance or the face size, whichever is larger
INSIDE = np.array([case["margin"] for case in CASES]) > 1e-6
CATEGORY = np.array([case["category"] for case in CASES])
# Misses that robust may have; a T6 at its centre of curvature is a curved T6 as well.
MAY_MISS = {"collapsed_q4", "quarter_point_q8", "aspect_1e6", "curved_t6"}


def run(method):
    """Errors of the distance, relative as above; evaluations, statuses, places and certificates of each case."""
    found = []
    for case in CASES:
        try:
            answer = ct.project(case["kind"], case["nodes"], [case["point"]], method=method)
        except NotImplementedError:
            pytest.skip(f"{method} is not in this build")
        error = (answer.distance[0] - case["distance"]) / max(
            case["distance"], corpus.face_size(case["nodes"])
        )
        found.append(
            (error, answer.evaluations[0], answer.status[0], answer.where[0], answer.certified[0])
        )
    return [np.array(column) for column in zip(*found)]


def by_category(wrong):
    return {name: int(np.sum(wrong & (CATEGORY == name))) for name in np.unique(CATEGORY[wrong])}


def test_the_stored_cases_are_those_of_the_generator():
    cases = corpus.generate()
    assert len(cases) == len(CASES) >= 2000
    for (category, kind, nodes, point), stored in zip(cases, CASES):
        assert (category, kind) == (stored["category"], stored["kind"])
        np.testing.assert_allclose(
            nodes, stored["nodes"], rtol=1e-12, atol=1e-12 * np.max(np.abs(nodes))
        )
        np.testing.assert_allclose(
            point, stored["point"], rtol=1e-12, atol=1e-12 * np.max(np.abs(point))
        )


def test_truths_of_a_random_sample_come_out_again():
    for i in np.random.default_rng().choice(len(CASES), 20, replace=False):
        case = CASES[i]
        distance, _, _ = corpus.truth(case["kind"], case["nodes"], case["point"])
        assert distance == pytest.approx(
            case["distance"], rel=1e-11, abs=1e-12 * corpus.face_size(case["nodes"])
        ), (i, case["category"])


def test_robust_finds_the_closest_point():
    error, evaluations, _, _, _ = run("robust")
    assert np.min(error) > -1e-12  # no point is closer than the true one
    wrong = ~(np.abs(error) <= RIGHT)
    print(
        f"robust: {100 * np.mean(~wrong):.2f} % right, misses {by_category(wrong)}, median {np.median(evaluations):.0f} evaluations"
    )
    assert np.mean(~wrong) >= 0.9984
    for i in np.flatnonzero(wrong):
        assert (
            CATEGORY[i] in MAY_MISS
            or CASES[i]["kind"] == "T6"
            and CATEGORY[i] == "centre_of_curvature"
        ), (i, CATEGORY[i], error[i])


def test_certified_is_always_right_and_never_claims_too_much():
    error, _, _, _, certified = run("certified")
    wrong = ~(np.abs(error) <= RIGHT)
    print(
        f"certified: {100 * np.mean(~wrong):.2f} % right, {100 * np.mean(~certified):.2f} % without a certificate {by_category(~certified)}, "
        f"{100 * np.mean(np.abs(error) <= 1e-10):.2f} % at 1e-10"
    )
    assert not np.any(certified & ~(np.abs(error) <= 1e-10))  # the statement of a certificate
    assert not np.any(wrong), by_category(wrong)
    assert np.mean(np.abs(error) <= 1e-10) >= 0.999
    assert np.mean(~certified) <= 0.01, by_category(~certified)


def test_the_simplex_of_the_paper_is_right_or_says_outside():
    error, evaluations, _, where, _ = run("simplex")
    right = (np.abs(error) <= RIGHT) | (~INSIDE & (where == "outside"))
    print(
        f"simplex: {100 * np.mean(right):.2f} % right, misses {by_category(~right)}, median {np.median(evaluations):.0f} evaluations"
    )
    assert np.mean(right) >= 0.95
    assert np.median(evaluations) <= 300
    # It stops early in long narrow valleys, and almost nowhere else.
    narrow = np.isin(CATEGORY, ["aspect_1e3", "aspect_1e6", "needle_triangle"])
    assert np.mean(right[~narrow]) >= 0.985


def test_newton_needs_few_looks_and_fails_often():
    """The comparison of the paper: fast where it works."""
    error, evaluations, status, where, _ = run("newton")
    right = (np.abs(error) <= RIGHT) | (~INSIDE & (where == "outside"))
    assert 0.7 < np.mean(right) < 0.95 and np.median(evaluations) <= 6
    ordinary = CATEGORY == "ordinary"
    assert np.all(right[ordinary])
    assert np.mean(right[CATEGORY == "two_lobes"]) < 0.5 and np.all(
        status[(CATEGORY == "two_lobes") & ~right] != ct.Status.OK
    )
