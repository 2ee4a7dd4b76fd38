"""What bricks of other cells cost."""

from __future__ import annotations

import tempfile
import zipfile

import numpy as np
from libcontact.meshes import gmsh
from libcontact.meshes.bricks import Split
from libcontact.meshes.convert import SHAPES
from libcontact.meshes.raw import Reading

from .shared import ROOT, Numbers, measurement, scene_of, stable_step

MESHES = ROOT / "tests" / "data" / "meshes.zip"


def steps_of(nodes: np.ndarray, elements: np.ndarray) -> np.ndarray:
    """The stable step of a mesh alone, bounded by single elements and by the assembled matrix."""
    used, number = np.unique(elements, return_inverse=True)
    scene = scene_of(poisson=0.3).add_body(
        "b",
        material="elastic",
        nodes=nodes[used],
        elements=number.reshape(elements.shape).astype(np.int32),
    )
    bounds = ("elements", "assembled")
    return np.array([stable_step(scene.set_time(end=1.0, stable_step=each)) for each in bounds])


@measurement
def mesh_cost() -> Numbers:
    """The cam's wedges and a box of tetrahedra, each cell as one brick with collapsed sides, and split into three or
    four: elements, steps over that of the single elements of the first, and elements times steps of the second over
    those of the first."""
    out = Numbers()
    for name in ("cam", "tets"):
        with tempfile.TemporaryDirectory() as folder, zipfile.ZipFile(MESHES) as archive:
            raw = gmsh.read(Reading(archive.extract(f"{name}.msh", folder)))
        blocks = [each for each in raw.blocks if each.kind in SHAPES]
        whole = np.concatenate([each.nodes[:, SHAPES[each.kind]] for each in blocks])
        split = Split(raw.nodes, blocks, wedges=True)
        kept, made = steps_of(raw.nodes, whole), steps_of(split.nodes, split.elements)
        work = len(split.elements) / len(whole) * kept / made
        out |= {f"{name}_kept": len(whole), f"{name}_split": len(split.elements)}
        for i, bound in enumerate(("elements", "assembled")):
            out[f"{name}_{bound}_kept"] = kept[i] / kept[0]
            out[f"{name}_{bound}_split"] = made[i] / kept[0]
            if name == "cam":
                out[f"{name}_{bound}_work"] = work[i]
    for name in ("cam", "tets"):
        del out[f"{name}_elements_kept"]  # 1
    return out
