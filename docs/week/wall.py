"""A mass meets a wall: one equation of motion, one condition, and two ways to obey it."""

import numpy as np


def ramp(gap_free, gap_before, W, penalty):
    """Contact force, from the gap without it and the gap one step before."""
    return max(0.0, -gap_free - min(gap_before, 0.0)) / (2.0 / penalty + W)  # (eq:week-ramp)


def bounce(penalty, dt, gap=1.0, controlled=False):
    """Gaps at the steps and velocities between them of a unit mass of speed 1 at a wall."""
    gaps, velocities = [gap + dt, gap], [-1.0]
    while velocities[-1] < 0.0 or gaps[-1] < 0.0:
        free = gaps[-1] + dt * velocities[-1]
        if controlled:
            force = ramp(free, gaps[-2], dt * dt, penalty)
        else:
            force = penalty * max(0.0, -gaps[-1])  # (eq:week-penalty)
        # The leapfrog (eq:week-leapfrog)
        velocities.append(velocities[-1] + dt * force)
        gaps.append(gaps[-1] + dt * velocities[-1])
        if len(gaps) > 1_000_000:
            raise RuntimeError("the mass does not come back")
    return np.array(gaps[1:]), np.array(velocities)


def rebound(step, controlled=False, samples=200):
    """Speeds after the impact for steps of `step`/ω, from starts that lie between two steps."""
    starts = 1.0 + step * (np.arange(samples) + 0.5) / samples
    return np.array([bounce(1.0, step, start, controlled)[1][-1] for start in starts])


if __name__ == "__main__":
    gaps, velocities = bounce(penalty=100.0, dt=0.01)
    print(f"deepest point {gaps.min():.4f}, by hand {-1 / np.sqrt(100.0):.4f}")
    print(f"time in contact {0.01 * (gaps < 0).sum():.3f}, by hand {np.pi / np.sqrt(100.0):.3f}")
    for step in (0.1, 0.5, 1.0, 1.5):
        speeds = [rebound(step, controlled) for controlled in (False, True)]
        told = " and ".join(f"{found.min():.3f} ... {found.max():.3f}" for found in speeds)
        print(f"steps of {step} / ω: rebound at {told}")
