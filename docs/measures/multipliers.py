"""Unlike meshes joined by multipliers, and what replaces these: penalties and forces of nodes."""

from __future__ import annotations

import warnings

import numpy as np

import libcontact as ct

from .shared import Numbers, hat, measurement, scene_of


def brick(size: np.ndarray, young: float) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness (24, 24) of a box with ν = 0 by 2 x 2 x 2 Gauss points, and σz in its centre for unit displacements
    (24,)."""
    corners = np.array(np.meshgrid(*[[-1, 1]] * 3, indexing="ij")).reshape(3, 8)
    stiffness, modulus = np.zeros((24, 24)), young * np.array([1, 1, 1, 0.5, 0.5, 0.5])
    for point in [*(corners.T / np.sqrt(3)), np.zeros(3)]:
        near = 1 + corners * point[:, None]
        slope = corners / 4 * near[[1, 2, 0]] * near[[2, 0, 1]] / size[:, None]
        B = np.zeros((6, 8, 3))
        for i, (j, k) in enumerate(((1, 2), (2, 0), (0, 1))):
            B[i, :, i], B[3 + i, :, j], B[3 + i, :, k] = slope[i], slope[k], slope[j]
        B = B.reshape(6, 24)
        if point.any():
            stiffness += B.T * modulus @ B * np.prod(size) / 8
    return stiffness, young * B[2]


def common(n: int, m: int) -> np.ndarray:
    """Integrals (n + 1, m + 1) of products of the shape functions of n and of m equal elements on 0 ... 1, over the
    common pieces of both."""
    cuts = np.unique(np.r_[np.arange(n + 1) / n, np.arange(m + 1) / m])
    middle, half = (cuts[1:] + cuts[:-1]) / 2, np.diff(cuts) / 2
    points = np.r_[middle - half / np.sqrt(3), middle + half / np.sqrt(3)]
    return (hat(points, n) * np.r_[half, half]) @ hat(points, m).T


@measurement
def mortar() -> Numbers:
    """The hex8 blocks of ``recovered_blocks``, two elements high, at rest and joined by multipliers on the finer face,
    with integrals over the common pieces of both meshes: largest errors of a multiplier and of the stress of an
    element."""
    found = {"node": 0.0, "stress": 0.0}
    for coarse, fine in ((8, 11), (2, 14)):
        nodes = [np.arange(3 * (n + 1) ** 2).reshape(n + 1, n + 1, 3) for n in (coarse, fine)]
        nodes[1] += nodes[0].size
        below, above, size = nodes[0][..., 2], nodes[1][..., 0], 3 * (nodes[1].max() + 1)
        A, b = np.zeros((size + above.size,) * 2), np.zeros(size + above.size)
        pieces = []
        for n, node in zip((coarse, fine), nodes):
            K, row = brick(np.array([1 / n, 1 / n, 0.25]), 1000.0)
            near = [slice(None, -1), slice(1, None)]
            corners = np.stack([node[i, j, k] for i in near for j in near for k in near], -1)
            for one in corners.reshape(-1, 8):
                freedoms = (3 * one[:, None] + np.arange(3)).ravel()
                A[np.ix_(freedoms, freedoms)] += K
                pieces.append((freedoms, row))
        for node, sign, n in ((above, 1, fine), (below, -1, coarse)):
            joined = sign * np.kron(common(fine, n), common(fine, n))
            A[size:, 3 * node.ravel() + 2] = joined
            A[3 * node.ravel() + 2, size:] = joined.T
        b[3 * nodes[1][..., 2].ravel() + 2] = -np.kron(*[common(fine, fine).sum(axis=1)] * 2)
        held = [3 * node[0].ravel() for node in nodes] + [
            3 * node[:, 0].ravel() + 1 for node in nodes
        ]
        free = np.delete(
            np.arange(len(b)), np.concatenate([*held, 3 * nodes[0][..., 0].ravel() + 2])
        )
        x = np.zeros(len(b))
        x[free] = np.linalg.solve(A[np.ix_(free, free)], b[free])
        stress = [row @ x[freedoms] for freedoms, row in pieces]
        for name, values in (("node", np.abs(x[size:])), ("stress", -np.array(stress))):
            found[name] = max(found[name], np.abs(values - 1).max())
    return found


def stiffest_over_softest(n: int, m: int, slip: float = 0.0) -> tuple[int, int, float]:
    """
    Two plane faces of n x n and m x m hex8 that touch, one slid along both edges by ``slip`` times the coarser element:
    contact points, rank of W, :eq:`constraint-problem`, for layers of cubes, and its largest over its smallest
    eigenvalue that is not 0.
    """
    rows = []
    for own, other, sign in ((n, m, 1), (m, n, -1)):
        x = ((np.arange(own) + 0.5)[:, None] + np.array([-0.5, 0.5]) / np.sqrt(3)).ravel() / own
        met = np.clip(x + sign * slip / min(n, m), 0, 1)
        both = [np.kron(hat(x, own), hat(x, own)).T, -np.kron(hat(met, other), hat(met, other)).T]
        rows.append(np.hstack(both[::sign]))
    mass = [
        np.kron(line, line) / c for c in (n, m) for line in [np.r_[0.5, np.ones(c - 1), 0.5] / c]
    ]
    G = np.vstack(rows)
    found = np.linalg.svd(G / np.sqrt(np.concatenate(mass)), compute_uv=False) ** 2
    found = found[found > 1e-13 * found[0]]
    return len(G), len(found), found[0] / found[-1]


def overlap(n: int, m: int, beta: float) -> float:
    """Two blocks of n and m elements along an edge that meet with a hundredth of the wave speed each, at 0.9 of the
    step: deepest overlap over the finer element. Each step must converge."""
    scene = scene_of(poisson=0.3)
    speed = 0.01 * np.sqrt(0.7 / (1.3 * 0.4))
    for name, z, cells, v in (("lower", -0.5, n, speed), ("upper", 0.0, m, -speed)):
        box = {
            "origin": [0, 0, z],
            "size": [1, 1, 0.5],
            "cells": [cells, cells, max(cells // 2, 1)],
        }
        scene.add_body(name, material="elastic", box=box, velocity=[0, 0, v])
    scene.add_contact("lower.z_max", "upper.z_min", beta=beta)
    deepest = []

    def look(run: ct.Run) -> None:
        deepest.append(max(0.0, -np.nanmin(run.contact[0]["gap"])))

    with warnings.catch_warnings():
        warnings.filterwarnings("error", "unconverged:")
        scene.set_time(end=1.0, fraction=0.9).set_output(every=1, fields=[]).run(
            progress=False, output=False, watch=look
        )
    return max(deepest) * max(n, m)


@measurement
def multipliers() -> Numbers:
    """Pairs of meshes: contact points, rank and eigenvalue ratio of W, the ratio after a slip of a thousandth of an
    element, and the overlap of an impact at three penalties."""
    found = {}
    for n, m in ((8, 8), (8, 16), (4, 5), (8, 11), (16, 23)):
        points, rank, ratio = stiffest_over_softest(n, m)
        found |= {f"{n}_{m}_points": points, f"{n}_{m}_rank": rank, f"{n}_{m}_ratio": ratio}
        found[f"{n}_{m}_slip"] = stiffest_over_softest(n, m, 1e-3)[2]
        if n < 16:
            found |= {f"{n}_{m}_{beta}": overlap(n, m, beta) for beta in (40, 1000, 10000)}
    return found


@measurement
def nodal_forces() -> Numbers:
    """A line of n elements pressed evenly on one of m, two Gauss points an element: largest error of a nodal force on
    each side, over the true one."""
    found = {}
    for name, n, m in (("2_3", 2, 3), ("4_5", 4, 5), ("10_73", 10, 73)):
        worst = []
        for own, other in ((n, m), (m, n)):
            exact = np.r_[0.5, np.ones(own - 1), 0.5] / own
            points = (
                (np.arange(other) + 0.5)[:, None] + np.array([-0.5, 0.5]) / np.sqrt(3)
            ).ravel() / other
            # Half of the force comes from the own points, without error; half is sampled at the points of the other
            # side.
            worst.append(np.max(np.abs(hat(points, own).sum(axis=1) / (2 * other) / exact - 1)) / 2)
        found |= (
            {f"{name}_coarse": worst[0], f"{name}_fine": worst[1]}
            if n * 2 < m
            else {name: max(worst)}
        )
    return found
