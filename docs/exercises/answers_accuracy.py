"""Answers of the exercises of the chapter on accuracy."""


def test_accuracy_digit(says):
    costs = [10 ** (3 / q) for q in (0.5, 0.7, 2)]
    assert round(costs[0]) == 10**6
    says("10⁶", f"{costs[1] / 1e4:.1f}·10⁴", f"{costs[2]:.0f}", "1.5")


def test_accuracy_front(says):
    runs = [(1, 0.10), (2, 0.07), (3, 0.08), (4, 0.04), (8, 0.038)]
    beaten = [a for a in runs if any(b != a and b[0] <= a[0] and b[1] <= a[1] for b in runs)]
    assert beaten == [(3, 0.08)]
    says(f"{100 * (1 - 0.038 / 0.04):.0f} %", given=("3, 0.08",))
