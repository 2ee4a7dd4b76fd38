"""
Scenes and results files that were changed at random: ``fuzz_scenes.py SECONDS SEED [FOLDER]``.

A scene file is made of random parts or is a good one with lines, keys, values or bytes changed. What comes out is a
``SceneError``, or a scene that explains itself or runs a few steps, or a ``RunError``. A results file has bytes or
whole blocks changed, or is cut: ``Run.load`` gives a run or says ``ValueError``, a restart goes on or says
``SceneError``. Each batch of files is read in a process of its own, since HDF5 itself may end on a damaged one; that is
counted apart ("hdf5").
"""

from __future__ import annotations

import json
import os
import random
import signal
import sys
import tempfile
import time
import tomllib
import traceback
import warnings
from collections import Counter
from pathlib import Path

from libcontact._core import lib
from libcontact.model import ENFORCEMENTS, INTEGRATORS, LAWS
from libcontact.run import Run, RunError

import libcontact as ct

KEYS = """
    x_min x_max y_min z_max xyz x hex8 hex20 linear neo_hookean penalty energy_controlled
    reduced box plane one two one.x_max two.x_min lobatto keep remove refuse chung_lee
    noh_bathe tchamwa_wielgosz assembled
""".split()
WRONG = """
    beta friction end velocity spin enforcement look_every energy_limit until_static points
    initial_penetration removal_time adjust dissipation integrator integrator_parameter
    stable_step
""".split()


def good_scene(chance: random.Random) -> dict:
    """A small scene that is right, mostly."""
    pick, size = chance.choice, lambda: [round(chance.uniform(0.5, 1.5), 3) for _ in range(3)]
    bodies = [
        {
            "name": name,
            "material": "soft",
            "box": {
                "origin": [x, 0, 0],
                "size": [1.0, *size()[1:]],
                "cells": [chance.randint(1, 2) for _ in range(3)],
            },
            "velocity": [v, 0, 0],
        }
        for name, x, v in (("one", -1.0, 0.1), ("two", pick([0.0, 0.0, -0.02, 0.02]), -0.1))
    ]
    for body in bodies:
        if chance.random() < 0.2:
            body["element"] = "hex20"
        if chance.random() < 0.1:
            body["kernel"] = pick(["general", "box", "plane", "auto"])
    scene = {
        "units": {"length": "m", "mass": "kg", "time": "s"},
        "body": bodies,
        "material": [
            {
                "name": "soft",
                "young": chance.uniform(0.5, 3),
                "poisson": chance.uniform(0, 0.45),
                "density": 1.0,
                "law": pick(list(LAWS)),
            }
        ],
        "time": {
            "end": chance.uniform(0.05, 0.5),
            pick(["fraction", "courant"]): chance.uniform(0.1, 0.5),
        },
    }
    if chance.random() < 0.7:
        scene["contact"] = [
            {
                "surfaces": pick([["one.x_max", "two.x_min"], ["one.outer", "two.outer"]]),
                "beta": chance.uniform(0.5, 4),
                **contact_choices(chance),
            }
        ]
    if chance.random() < 0.4:
        scene["support"] = [
            {"set": f"one.{pick(['x_min', 'y_min', 'z_max'])}", "fix": [pick("xyz")]}
        ]
    if chance.random() < 0.3:
        scene["gravity"] = {"acceleration": [0, 0, -1.0]}
    scene["time"] |= time_choices(chance)
    if chance.random() < 0.2:
        scene["output"] = {"every": chance.randint(1, 3), "fields": ["displacement"]}
    return scene


def contact_choices(chance: random.Random) -> dict:
    """Keys that a contact may have, each now and then."""
    pick, out = chance.choice, {}
    if chance.random() < 0.5:
        out["enforcement"] = pick(list(ENFORCEMENTS))
    if out.get("enforcement", "energy_controlled") == "energy_controlled" and chance.random() < 0.3:
        out["dissipation"] = chance.uniform(0, 1)
    if chance.random() < 0.3:
        out["points"] = pick(["gauss", "lobatto"])
    if chance.random() < 0.4:
        out["initial_penetration"] = pick(["force", "refuse", "keep", "remove"])
    if out.get("initial_penetration") == "remove":
        out["removal_time"] = chance.uniform(0.01, 1)
    if chance.random() < 0.2:
        out["friction"] = chance.uniform(0, 1)
    if chance.random() < 0.2:
        out["adjust"] = chance.uniform(0, 0.3)
    return out


def time_choices(chance: random.Random) -> dict:
    """Keys of the time table beside the end and the step."""
    out: dict = {}
    if chance.random() < 0.5:
        out["integrator"] = chance.choice(list(INTEGRATORS))
        facts = lib.ct_integrator_facts(INTEGRATORS[out["integrator"]])
        if facts.most > facts.least and chance.random() < 0.5:
            out["integrator_parameter"] = chance.uniform(facts.least, facts.most)
    if chance.random() < 0.3:
        out["stable_step"] = chance.choice(["elements", "assembled"])
    if chance.random() < 0.3:
        out["force_tolerance"] = 10 ** chance.uniform(-12, -1)
    if chance.random() < 0.3:
        out["energy_limit"] = 10 ** chance.uniform(-3, 1)
    if chance.random() < 0.3:
        out["look_every"] = chance.randint(1, 20)
    return out


def value(chance: random.Random):
    """Something that may stand in a scene file."""
    kind = chance.randrange(10)
    if kind < 4:
        return chance.choice(
            [
                0,
                1,
                -1,
                2,
                3,
                1e-300,
                1e300,
                -1.5,
                0.3,
                float("nan"),
                float("inf"),
                2**63 - 1,
                -(2**63),
                10**9,
            ]
        )
    if kind < 6:
        return chance.choice([*KEYS, "", "é", "a" * 300, "\0".replace("\0", " ")])
    if kind == 6:
        return chance.choice([True, False])
    if kind == 7:
        return [value(chance) for _ in range(chance.randrange(4))]
    if kind == 8:
        return {chance.choice(KEYS): value(chance)}
    return [chance.uniform(-1, 1) for _ in range(3)]


def places(node):
    if isinstance(node, dict):
        for key, item in node.items():
            yield node, key
            yield from places(item)
    elif isinstance(node, list):
        for i, item in enumerate(node):
            yield node, i
            yield from places(item)


def scene_text(chance: random.Random) -> bytes:
    """A scene file, wrong in one way or another."""
    import tomli_w

    scene = good_scene(chance)
    for _ in range(chance.choice([0, 0, 1, 1, 2, 5])):
        table, key = chance.choice(list(places(scene)))
        change = chance.randrange(4)
        if change == 0:
            del table[key]
        elif change == 1 and isinstance(table, dict):
            table[chance.choice(KEYS + WRONG)] = value(chance)
        else:
            table[key] = value(chance)
        if not list(places(scene)):
            break
    text = bytearray(tomli_w.dumps(scene).encode())
    for _ in range(chance.choice([0, 0, 0, 1, 3]) if text else 0):
        at = chance.randrange(len(text))
        text[at : at + chance.randrange(3)] = bytes(
            chance.randrange(256) for _ in range(chance.randrange(3))
        )
        if not text:
            break
    return bytes(text)


def try_scene(chance: random.Random, path: Path, counts: Counter) -> None:
    path.write_bytes(scene_text(chance))
    kind = "refused"
    try:
        scene = ct.Scene.load(path)
        tomllib.loads(scene.toml())
        if chance.random() < 0.5:
            kind = "read"
            if scene._built(None).step_count < 60:
                scene.run(progress=False, output=False, until=None)
                kind = "run"
        else:
            scene.explain()
            kind = "read"
    except ct.SceneError as error:
        assert error.reason and str(error), "a refusal has a reason"
        kind = "refused"
    except RunError as error:
        assert (
            error.time is not None and error.run is not None and "last good state" in str(error)
        ), "a fault tells where it is"
        kind = "failed"
    counts[kind] += 1


def damaged(chance: random.Random, good: bytes) -> bytes:
    data = bytearray(good)
    kind = chance.randrange(4)
    if kind == 0:
        del data[chance.randrange(len(data)) :]
    for _ in range(chance.choice([1, 1, 2, 10, 100])):
        at = chance.randrange(max(1, len(data) if chance.random() < 0.5 else min(len(data), 6000)))
        if kind == 1:
            data[at : at + 1] = bytes([chance.randrange(256)])
        elif kind == 2:
            length = chance.randrange(64)
            other = chance.randrange(len(data))
            data[at : at + length] = data[other : other + length]
        elif at < len(data):
            data[at] ^= 1 << chance.randrange(8)
    return bytes(data)


def rebuilt(chance: random.Random, path: Path, good: bytes) -> None:
    """The good file with objects or attributes that are gone, or of another type and shape."""
    import h5py
    import numpy as np

    path.write_bytes(good)
    with h5py.File(path, "r+") as file:
        names: list[str] = []
        file.visit(names.append)
        for _ in range(chance.choice([1, 1, 3])):
            name = chance.choice(names)
            if name not in file:
                continue
            attributes = list(file[name].attrs)
            if attributes and chance.random() < 0.5:
                where, key = file[name].attrs, chance.choice(attributes)
            else:
                where, key = file, name
            del where[key]
            if chance.random() < 0.6:
                where[key] = chance.choice(
                    [
                        0,
                        -1,
                        2**40,
                        1.5,
                        float("nan"),
                        "text",
                        np.zeros(0),
                        np.full((2, 3), np.nan),
                        np.arange(7),
                        np.zeros(3, "i1,f8"),
                        np.full((1, 1, 1), -5),
                    ]
                )


def try_file(
    chance: random.Random, path: Path, good: bytes, scene: ct.Scene, counts: Counter
) -> None:
    if chance.random() < 0.4:
        rebuilt(chance, path, good)
    else:
        path.write_bytes(damaged(chance, good))
    try:
        Run.load(path)
        kind = "file read"
    except ValueError as error:
        assert str(path.name) in str(error), "a refusal names the file"
        kind = "file refused"
    counts[kind] += 1
    try:
        scene.run(progress=False, restart=path, output=False)
        kind = "restarted"
    except ct.SceneError:
        kind = "restart refused"
    except RunError:
        kind = "restart failed"
    counts[kind] += 1


def in_child(work, seconds: float) -> tuple[int, str]:
    """Run work() in a process of its own: how it ended, and what it wrote."""
    receive, send = os.pipe()
    pid = os.fork()
    if pid == 0:
        os.close(receive)
        signal.alarm(int(seconds) + 60)
        code = 1
        try:
            os.write(send, json.dumps(work()).encode()[:60000])
            code = 0
        except BaseException:
            os.write(send, traceback.format_exc().encode()[-60000:])
        finally:
            os._exit(code)
    os.close(send)
    text = b""
    while part := os.read(receive, 65536):
        text += part
    os.close(receive)
    return os.waitpid(pid, 0)[1], text.decode(errors="replace")


def run_batch(counts: Counter, batch, seconds: float, who: str, hdf5: bool, form="") -> None:
    """Add what a batch counts. It may end by a signal in HDF5, which is counted, too; any other end is an
    AssertionError that names the batch."""
    status, text = in_child(batch, seconds)
    if os.WIFSIGNALED(status) and hdf5 and os.WTERMSIG(status) != signal.SIGALRM:
        counts["ended by HDF5"] += 1
    elif status != 0:
        raise AssertionError(f"{who}: status {status}\n{text}")
    else:
        counts.update({form + told: n for told, n in json.loads(text).items()})


def campaign(
    seconds: float, seed: int, folder: Path | None = None, rounds: int | None = None
) -> dict[str, int]:
    """Change scenes and files for so long (or for so many rounds of 400 scenes and 20 files); the counts of what came
    out. A broken promise is an AssertionError that names the seed."""
    warnings.simplefilter("ignore")
    counts: Counter = Counter()
    with tempfile.TemporaryDirectory(dir=folder) as name:
        plain = good_scene(random.Random(3))
        plain["output"] = {"every": 1}
        scene, good = ct.Scene(plain), b""
        if ct.has("hdf5"):
            scene.run(progress=False, output=Path(name) / "good.vtkhdf", until=0.05)
            good = (Path(name) / "good.vtkhdf").read_bytes()
        end, first = time.monotonic() + seconds, seed
        while time.monotonic() < end if rounds is None else seed < first + 2 * rounds:
            for kind, number in (("scenes", 400), ("files", 20)):

                def batch(kind=kind, number=number, seed=seed):
                    chance, told = random.Random(seed), Counter()
                    for _ in range(number):
                        if kind == "scenes":
                            try_scene(chance, Path(name) / "scene.toml", told)
                        else:
                            try_file(chance, Path(name) / "damaged.vtkhdf", good, scene, told)
                    return told

                seed += 1
                if kind == "files" and not good:
                    continue
                run_batch(counts, batch, 120.0, f"seed {seed - 1}, {kind}", kind == "files")
    return {**counts, "next seed": seed}


if __name__ == "__main__":
    where = Path(sys.argv[3]) if len(sys.argv) > 3 else None
    print(json.dumps(campaign(float(sys.argv[1]), int(sys.argv[2]), where)))
