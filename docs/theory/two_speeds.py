"""Pushforward and pullback with two speeds, tried out on quadrilaterals in plane strain: what it would bring. The library has one speed."""

import numpy as np

import libcontact as ct

SIGNS = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
SHARE = 0.7  # θ
TIMES = np.linspace(0.50, 0.60, 9)  # c₁t/d
ONE, COMPONENTS, ISOTROPIC = "one speed", "components", "isotropic"


class Mesh:
    """A square of d × d with n × n elements, in units d = ρ = c₁ = 1; inner nodes moved by up to `shaken` edges, and the half z > d/2 with speeds `slow` times those of the other."""

    def __init__(self, n, nu=0.3, shaken=0.0, slow=1.0):
        self.n, self.nu = n, nu
        grid = np.stack(np.meshgrid(*2 * [np.linspace(0, 1, n + 1)], indexing="ij"), -1)
        grid[1:-1, 1:-1] += np.random.default_rng(5).uniform(
            -shaken / n, shaken / n, (n - 1, n - 1, 2)
        )
        at = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
        self.elements = np.stack([at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]], -1).reshape(
            -1, 4
        )
        self.nodes = grid.reshape(-1, 2)
        self.dofs = (2 * self.elements[..., None] + np.arange(2)).reshape(-1, 8)
        self.centres = self.nodes[self.elements].mean(1)
        self.stiff = np.where(self.centres[:, 1] > 0.5, slow**2, 1.0)  # λ + 2μ
        self.mu = self.stiff * (1 - 2 * nu) / (2 * (1 - nu))
        self.assemble()

    def gradients(self, xi):
        """Slopes of the four shapes (elements, 4, 2) and the Jacobian at a place of the elements."""
        slopes = SIGNS * (1 + SIGNS * xi)[:, ::-1] / 4
        jacobian = np.einsum("eai,aj->eij", self.nodes[self.elements], slopes)
        return slopes @ np.linalg.inv(jacobian), np.linalg.det(jacobian)

    def assemble(self, turn=0.0):
        """Element matrices by Gauss' rule of the strains: both normal ones together, each stress unit by itself, in axes that are turned by an angle."""
        axes = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
        lam, mass = self.stiff - 2 * self.mu, np.zeros(self.dofs.shape)
        self.normal, self.shear = np.zeros((2, len(lam), 8, 8))
        for xi in SIGNS / np.sqrt(3):
            slopes, det = self.gradients(xi)
            along = [(slopes @ own)[..., None] * own for own in axes]  # ε of each axis
            strain = [one.reshape(-1, 8) for one in along]
            slip = sum((slopes @ axes[k])[..., None] * axes[1 - k] for k in (0, 1)).reshape(-1, 8)
            for i in (0, 1):
                for j in (0, 1):
                    modulus = det * (self.stiff if i == j else lam)
                    self.normal += np.einsum("e,ea,eb->eab", modulus, strain[i], strain[j])
            self.shear += np.einsum("e,ea,eb->eab", det * self.mu, slip, slip)
            mass += np.repeat(det[:, None] * (1 + SIGNS * xi).prod(1) / 4, 2, axis=1)
        self.mass = np.bincount(self.dofs.ravel(), mass.ravel())

    def dilatation(self):
        """Matrices of (λ + 2μ) (div u)²; the rest of the stiffness belongs to the shear waves, up to terms of the boundary."""
        found = 0.0
        for xi in SIGNS / np.sqrt(3):
            slopes, det = self.gradients(xi)
            div = slopes.reshape(-1, 8)
            found = found + np.einsum("e,ea,eb->eab", det * self.stiff, div, div)
        return found

    def force(self, matrices, u):
        """Assembled product."""
        own = np.matmul(matrices, u[self.dofs][..., None]).ravel()
        return np.bincount(self.dofs.ravel(), own, 2 * len(self.nodes))

    def whole(self, matrices):
        """Assembled matrix, scaled from both sides with the roots of the masses."""
        found = np.zeros(2 * [2 * len(self.nodes)])
        np.add.at(found, (self.dofs[:, :, None], self.dofs[:, None, :]), matrices)
        return found / np.sqrt(np.outer(self.mass, self.mass))

    def stress(self, u):
        """σx, σz at the centres of the elements."""
        slopes, _ = self.gradients(np.zeros(2))
        own = np.einsum("eai,eai->ei", u.reshape(-1, 2)[self.elements], slopes)
        return (self.stiff - 2 * self.mu) * own.sum(1) + 2 * self.mu * own.T


def pulled(mesh, split, push):
    """N and W of :eq:`two-speeds`: what the drift takes of the velocity, and of the acceleration, with a push of P waves over so many steps; shear waves are pushed farther by c₁/c₂."""
    ratio = np.sqrt(mesh.stiff / mesh.mu)[:, None, None]
    first = mesh.dilatation() if split == ISOTROPIC else mesh.normal
    second = mesh.normal + mesh.shear - first
    longer = push if split == ONE else push * ratio
    parts = [(SHARE / 6 * (own**2 - 1) * K, own) for K, own in ((first, push), (second, longer))]
    return sum(K for K, _ in parts), 0.5 * sum(own * K for K, own in parts)


def plate(mesh, split, courant, times=TIMES, push=None):
    """Stresses of the reference plate at the steps nearest to the times; the push of P waves is one edge, or so many steps. `split` is a number for φ of Tchamwa and
    Wielgosz."""
    dt, stiffness = courant / mesh.n, mesh.normal + mesh.shear
    velocity, inverse = np.zeros((len(mesh.nodes), 2)), (1 / mesh.mass).reshape(-1, 2)
    velocity[:, 0] = np.where(mesh.nodes[:, 0] == 0, 0, -1)
    inverse = np.where(mesh.nodes == 0, 0, inverse).ravel()
    v, u, found = velocity.ravel(), np.zeros(velocity.size), {}
    N, W = pulled(mesh, split, push or 1 / courant) if isinstance(split, str) else (None, None)
    steps = [round(t / dt) for t in times]
    for i in range(max(steps) + 1):
        if i in steps:
            found[i] = mesh.stress(u)
        a, extra = -inverse * mesh.force(stiffness, u), 0.0
        if N is not None and i > 0:
            own = mesh.force(N, dt * v + 0.5 * dt**2 * a) + mesh.force(W, dt**2 * a)
            extra = dt**2 * inverse * own
        elif N is None:
            extra = dt**2 * (split - 1) * a
        v = v + dt * a
        u = u + dt * v + extra
    return [(i * dt, *found[i]) for i in steps]


def errors(mesh, split, courant):
    """Mean L1 errors on the lines of Figs. 4 and 5, against the closed form at the elements' centres."""
    n, found = mesh.n, []
    at = np.arange(n * n).reshape(n, n)
    row, column = at[:, 0], at[round(0.4 * n) - 1 : round(0.4 * n) + 1]
    unit = mesh.nu / (1 - mesh.nu)
    for t, sx, sz in plate(mesh, split, courant):
        x, place = mesh.centres[row, 0], mesh.centres[column].mean(0)
        own = sx[row] / unit - ct.exact.plates(x, 0 * x, t, mesh.nu).stress.sigma_x
        exact = ct.exact.plates(*place.T, t, mesh.nu).stress.sigma_z
        found.append([np.abs(own).mean(), np.abs(sz[column].mean(0) / unit - exact).mean()])
    return np.mean(found, axis=0)


def growth(mesh, split, fraction):
    """Spectral radius of a step of this fraction of the leapfrog's, and of the push that belongs to it, on a free mesh; less 1."""
    K = mesh.whole(mesh.normal + mesh.shear)
    dt2 = fraction**2 * 4 / np.linalg.eigvalsh(K)[-1]
    # A push of one edge at the speed of P waves.
    N, W = (dt2 * mesh.whole(own) for own in pulled(mesh, split, 1 / (mesh.n * np.sqrt(dt2))))
    A, one = dt2 * K, np.eye(len(K))
    step = np.block([[one - A - (0.5 * N + W) @ A, one + N], [-A, one]])
    return np.abs(np.linalg.eigvals(step)).max() - 1


def limit(mesh, split):
    """The largest stable step over that of the leapfrog, from :eq:`two-speeds-limit`; the push is one edge."""
    K = mesh.whole(mesh.normal + mesh.shear)
    values, vectors = np.linalg.eigh(K)
    root = vectors * np.sqrt(np.abs(values)) @ vectors.T
    low, high = 0.3, 1.0
    while high - low > 1e-4:
        part = 0.5 * (low + high)
        dt2 = part**2 * 4 / values[-1]
        W = mesh.whole(pulled(mesh, split, 1 / (mesh.n * np.sqrt(dt2)))[1])
        stable = np.linalg.eigvalsh(dt2 * K + 2 * dt2**2 * root @ W @ root)[-1] <= 4
        low, high = (part, high) if stable else (low, part)
    return low


def layers(splits, n=40, finest=120):
    """Mean error of σz over the fields of the fast and the slow half, each over the mean of |σz|, against Tchamwa and Wielgosz on finer elements."""
    fine = Mesh(finest, slow=0.5)
    every = slice(finest // n // 2, None, finest // n)
    truth = plate(fine, 2 / 1.95, 0.9, [0.56])[0][2].reshape(finest, finest)[every, every].ravel()
    mesh = Mesh(n, slow=0.5)
    slow, found = mesh.centres[:, 1] > 0.5, {}
    for split in splits:
        own = np.abs(plate(mesh, split, 0.7, [0.56])[0][2] - truth) / np.abs(truth).mean()
        found[split] = own[~slow].mean(), own[slow].mean()
    return found
