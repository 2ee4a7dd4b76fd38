"""Answers of the exercises of the chapter on the stable step."""

import itertools

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.linalg import eigsh


def test_stable_quadratic(says):
    K = np.array([[7, -8, 1], [-8, 16, -8], [1, -8, 7]]) / 3
    root = 1 / np.sqrt([1 / 6, 2 / 3, 1 / 6])
    found = np.linalg.eigvalsh(root[:, None] * K * root)
    assert abs(found[-1] - 24) < 1e-12
    says(
        f"{2 / np.sqrt(found[-1]):.3f}",
        "0.5",
        f"{0.5 / (2 / np.sqrt(found[-1])) - 1:.0%}".replace("%", " %"),
    )


def test_stable_growth(says):
    x2 = 2.01**2
    q = np.linalg.eigvals([[1 - x2, 1], [-x2, 1]])
    q = q[np.abs(q).argmax()].real
    says(f"{q:.4f}", f"{abs(q) ** 100 / 1e8:.1f}·10⁸", str(int(np.ceil(16 / np.log10(abs(q))))))


def test_stable_damped(says):
    """The largest step whose matrix has no eigenvalue outside the unit circle."""
    for d in (1.0, 2.0):
        steps = np.arange(0.5, 2.0, 1e-4)
        stable = [
            np.abs(np.linalg.eigvals([[1 - d * s, -s], [s * (1 - d * s), 1 - s * s]])).max()
            < 1 + 1e-9
            for s in steps
        ]
        limit = steps[np.argmin(stable)]
        says(f"{limit:.3f}")


def cube():
    """Stiffness of a cube of edge 1 with λ + 2μ = 1, ν = 0.3, and its corners."""
    corners = np.array(list(itertools.product((-1, 1), repeat=3)))
    mu = 1 / 3.5
    first = 1 - 2 * mu
    C = np.diag([2 * mu] * 3 + [mu] * 3)
    C[:3, :3] += first
    K = np.zeros((24, 24))
    for point in itertools.product((-1 / np.sqrt(3), 1 / np.sqrt(3)), repeat=3):
        f = 1 + corners * point
        g = corners * np.stack([f[:, 1] * f[:, 2], f[:, 0] * f[:, 2], f[:, 0] * f[:, 1]], 1) / 4
        B = np.zeros((6, 24))
        for i in range(3):
            B[i, i::3] = g[:, i]
            j, k = (i + 1) % 3, i
            B[3 + i, j::3], B[3 + i, k::3] = g[:, k], g[:, j]
        K += B.T @ C @ B / 8
    return K, (corners + 1) // 2


def test_stable_cubes(says):
    K, corners = cube()
    for n in (1, 2, 4, 6):
        first = np.array(list(itertools.product(range(n), repeat=3)))
        nodes = (first[:, None] + corners) @ [(n + 1) ** 2, n + 1, 1]
        mass = np.bincount(nodes.ravel(), minlength=(n + 1) ** 3) / 8
        dofs = (3 * nodes[:, :, None] + np.arange(3)).reshape(len(nodes), 24)
        values = K[None] / np.sqrt(
            np.repeat(mass, 3)[dofs][:, :, None] * np.repeat(mass, 3)[dofs][:, None]
        )
        rows, columns = np.broadcast_arrays(dofs[:, :, None], dofs[:, None])
        matrix = coo_array((values.ravel(), (rows.ravel(), columns.ravel()))).tocsr()
        start = np.random.default_rng(1).normal(size=matrix.shape[0])
        largest = eigsh(matrix, k=1, v0=start, return_eigenvectors=False)[0]
        says(f"{2 / np.sqrt(largest):.3f}")


def test_stable_mean(says, run):
    names, told = run()
    assert names["largest"](names["lengths"]) > 1e10 and "step 0.874" in told
    names, told = run(mend=True)
    assert names["largest"](names["lengths"]) < 5
    says(f"{names['step_of'](names['lengths']):.2f}", f"{0.874 / 0.19:.1f}", given=("0.874",))
