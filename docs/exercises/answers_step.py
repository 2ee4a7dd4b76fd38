"""Answers of the exercises of the chapter on central differences."""

import numpy as np


def test_step_fast(says):
    """From the eigenvalues of one step."""
    for x in (0.5, 1.0):
        step = np.array([[1 - x * x, 1], [-x * x, 1]])
        frequency = abs(np.angle(np.linalg.eigvals(step)[0]))
        says(f"{100 * (frequency / x - 1):.2f}", f"{100 * x * x / 24:.2f}")


def test_step_period(says):
    x = np.sqrt(24e-4)
    says(f"{x:.4f}", f"{2 * np.pi / x:.1f}", "129")
    late = [100 * (2 * n / (2 * np.pi) * np.arcsin(np.pi / n) - 1) for n in (128, 129)]  # periods
    assert late[1] < 0.01 < late[0]


def test_step_count(says):
    steps = [0.56 * 100 / courant for courant in (0.125, 0.965)]
    dt = 0.125 * 25e-6 / 6020
    says(f"{steps[0]:.0f}", f"{np.ceil(steps[1]):.0f}", f"{steps[1]:.2f}", f"{dt * 1e9:.3f}")
    says(f"{steps[0] * dt * 1e6:.3f}")


def test_step_reverse(says):
    def leapfrog(u, v, steps, dt=0.1):
        v -= dt / 2 * np.sin(u)
        for n in range(steps):
            u += dt * v
            v -= (dt if n < steps - 1 else dt / 2) * np.sin(u)
        return u, v

    def euler(u, v, steps, dt=0.1):
        for _ in range(steps):
            u, v = u + dt * v, v - dt * np.sin(u)
        return u, v

    ends = []
    for method in (leapfrog, euler):
        u, v = method(2.0, 0.0, 1000)
        ends.append(method(u, -v, 1000))
    assert np.abs(np.array(ends[0]) - [2, 0]).max() < 1e-12 and abs(ends[1][0] - 2) > 2 * np.pi
    says("10⁻¹³", "gains")


def test_step_start(says, run):
    _, told = run()
    errors = [float(line.split()[-1]) for line in told.splitlines()]
    assert all(1.9 < a / b < 2.2 for a, b in zip(errors, errors[1:]))
    names, told = run(mend=True)
    errors = [abs(names["oscillate"](n) - np.cos(10)) for n in (100, 200, 400)]
    assert all(3.9 < a / b < 4.1 for a, b in zip(errors, errors[1:]))
    says(f"{errors[0]:.4f}", f"{errors[1]:.5f}", f"{errors[2]:.5f}")
