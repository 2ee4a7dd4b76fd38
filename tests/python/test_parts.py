"""Parts of a problem, which the processes of a run build: what they share with the whole one, without MPI."""

import numpy as np
import pytest
from libcontact.cutting import can_be_parted, parts_of
from libcontact.pieces import common_nodes, elements_of, owners_of
from libcontact.problem import Problem

import libcontact as ct

SOFT = {"name": "soft", "young": 900, "poisson": 0.3, "density": 1}
STIFF = {**SOFT, "name": "stiff", "young": 3000}


def scene(cells=(8, 3, 6), **more):
    """Two blocks with contact, a support, a load, and probes; the upper one is finer."""
    boxes = {
        "low": {"origin": [0, 0, -1], "size": [1.1, 1, 1], "cells": list(cells)},
        "up": {"origin": [0.1, 0, 0], "size": [1, 1, 1], "cells": [2 * cells[0], 3, cells[2]]},
    }
    data = {
        "units": {"length": "m", "mass": "kg", "time": "s"},
        "material": [SOFT, STIFF],
        "body": [{"name": k, "material": "soft", "box": box} for k, box in boxes.items()],
        "contact": [{"surfaces": ["low.z_max", "up.z_min"]}],
        "support": [{"set": "low.z_min", "fix": ["z"]}],
        "load": [{"surface": "up.z_max", "pressure": 2.0}],
        "probe": [
            {"name": "inside", "body": "low", "point": [0.5, 0.5, -0.5], "quantities": ["stress"]},
            {"name": "top", "surface": "up.z_max"},
        ],
        "time": {"end": 1.0, "fraction": 0.8},
        **more,
    }
    return ct.Scene(data)


def cut(made, count, how):
    """The whole problem, and the parts and problems of all processes but the first."""
    whole = made._built(None)
    owners = owners_of(whole, count, "coordinates")
    if how == "at random":
        owners = np.random.default_rng(2).integers(0, count, elements_of(whole)).astype(np.int32)
    for part in parts_of(whole, owners, count, common_nodes(whole)):
        yield whole, owners, part, Problem(whole.parts, None, 1, (), whole.dt, False, part)


@pytest.mark.parametrize("how", ["coordinates", "at random"])
def test_what_a_part_moves_has_the_masses_and_the_elements_of_the_whole(how):
    for number, (whole, owners, part, own) in enumerate(cut(scene(), 4, how), start=1):
        first = 0
        mass = np.frombuffer(memory(whole, whole.pointer.mass))
        for name, body in whole.bodies.items():
            piece, mine = part.bodies[name], own.bodies[name]
            elements = body.mesh.elements
            node_owners = np.array(
                [
                    owners[first:][(elements == n).any(axis=1).nonzero()[0]].min()
                    for n in piece.node_numbers
                ]
            )
            at = slice(mine.nodes.start, mine.nodes.stop)
            assert np.array_equal(part.node_owners[at], node_owners)  # the lowest of its elements
            moved = node_owners == number
            near = np.isin(elements, piece.node_numbers[moved]).any(axis=1).nonzero()[0]
            assert np.isin(near, piece.element_numbers).all()
            same = elements[piece.element_numbers]
            assert np.array_equal(piece.node_numbers[mine.mesh.elements], same)
            assert np.array_equal(mine.mesh.nodes, body.mesh.nodes[piece.node_numbers])
            ours = np.frombuffer(memory(own, own.pointer.mass))[mine.nodes]
            rows = body.nodes.start + piece.node_numbers
            assert np.array_equal(ours[moved], mass[rows][moved])
            assert mine.kernel == body.kernel == "box"
            assert mine.mesh.shortest_edge == body.mesh.shortest_edge
            assert all(map(np.array_equal, mine.mesh.bounds, body.mesh.bounds))
            first += len(elements)
        assert own.contacts == whole.contacts and own.effects == whole.effects


def memory(problem, pointer):
    from libcontact._core import ffi

    return ffi.buffer(pointer, 8 * problem.pointer.node_count)


def test_all_parts_have_whole_contact_surfaces_and_the_nodes_of_probes():
    for whole, _, part, own in cut(scene(), 3, "coordinates"):
        for surface in (("low", "z_max"), ("up", "z_min")):
            asked = "contact[0].surfaces"
            numbers = part.bodies[surface[0]].node_numbers
            assert np.array_equal(numbers[own.on(surface, asked)], whole.on(surface, asked))
        for ours, theirs in zip(own.probes, whole.probes):
            assert np.array_equal(part.numbers[ours.nodes], theirs.nodes)
        inside = own.probes[0].members["element"]
        assert part.bodies["low"].element_numbers[inside] == whole.probes[0].members["element"]


def test_parts_become_smaller_with_their_number():
    made, sizes = scene((16, 12, 16), contact=[], probe=[]), []
    for count in (2, 4, 8):
        sizes.append(max(len(part.owners) for _, _, part, _ in cut(made, count, "coordinates")))
    total = elements_of(made._built(None))
    # Half and a layer, and so on; each way beyond a cut has two layers of elements more.
    assert sizes[0] < 0.55 * total and sizes[1] < 0.4 * total and sizes[2] < 0.25 * total


def test_errors_have_the_numbers_of_the_whole():
    for _, _, part, _ in cut(scene(), 2, "coordinates"):
        numbers = part.bodies["low"].element_numbers
        last = int(np.argmax(numbers != np.arange(len(numbers))))
        at = {"body": 0, "element": last, "point": None}
        text, told = part.told(f'body "low": element {last} is inverted', at)
        assert told["element"] == numbers[last] != last > 0
        assert text == f'body "low": element {numbers[last]} is inverted'
        assert part.told("out of memory", {**at, "body": None})[0] == "out of memory"


def test_several_materials_and_own_velocities_are_those_of_the_elements():
    made = scene()
    ranges = {"soft": range(100), "stiff": range(100, 144)}
    sets = {name: {"elements": [*numbers]} for name, numbers in ranges.items()}
    box = made._built(None).bodies["low"].mesh
    body = {
        "name": "low",
        "nodes": box.nodes.copy(),
        "elements": box.elements.copy(),
        "sets": sets,
        "material": {"soft": "soft", "stiff": "stiff"},
        "velocity": [0.0, 0.0, 1.0],
    }
    data = made.data
    data["body"][0] = body
    for whole, _, part, own in cut(ct.Scene(data), 3, "coordinates"):
        at = part.bodies["low"].element_numbers
        assert np.array_equal(own.material_at["low"], whole.material_at["low"][at])
        moving = own.rows(own.pointer.initial_velocity)
        assert np.array_equal(moving, whole.rows(whole.pointer.initial_velocity)[part.numbers])


def test_relaxation_has_memory_at_each_node_and_needs_the_whole_problem():
    relaxed = scene(damping={"relaxation": True})
    assert not can_be_parted(relaxed._built(None)) and can_be_parted(scene()._built(None))
