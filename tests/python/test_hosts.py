"""Two plates hit each other in other programs, with the contact of this library: the same run as in a scene; and
CalculiX with its own contact. ``make test-hosts`` installs the programs and sets LIBCONTACT_HOSTS; each part is skipped
without its program."""

import csv
import importlib
import os
import shutil

import pytest

scipy = pytest.importorskip("scipy")
import hosts_table as table
import two_plates as plates

LONG = pytest.mark.skipif(not os.environ.get("LIBCONTACT_HOSTS"), reason="make test-hosts")
BETAS = pytest.mark.parametrize("beta", plates.FACTORS)


def host(name):
    pytest.importorskip(name, reason=f"{name} is not installed: make test-hosts")
    return importlib.import_module(f"host_{name}")


@LONG
@BETAS
@pytest.mark.parametrize("name", table.HOSTS)
def test_a_host_computes_the_run_of_the_scene(name, beta):
    """At 0.9 of the host's own step. The energy never rises: round-off of the sum over 40 000 numbers and 135 steps.
    Displacements differ by the tolerance of the forces, and by the coordinates of the meshes, which are rounded
    differently."""
    result = host(name).run(beta)
    assert result.rise < 1e-11 and 0.999 < result.energy[-1] / result.energy[0] < 1 + 1e-11
    scene = plates.run_scene(result, beta)
    assert len(result.shots) == 2
    for one, other in zip(result.shots, scene):
        assert plates.difference(one, other) < plates.TOLERANCE
    # The plates part: each goes back.
    for side, (X, u) in enumerate(zip(*result.shots[1])):
        mean = u.mean(axis=0)[0] - result.shots[0][1][side].mean(axis=0)[0]
        assert mean * plates.velocity(side)[0] < 0
    assert plates.stress(*(each[1] for each in result.shots[0])) == pytest.approx(-7 / 3, rel=0.01)


@LONG
def test_calculix_has_the_same_stress_with_its_own_contact():
    """Its contact is another law at another step, so only means agree: the stress behind the front, which has a closed
    form, and the displacement. At beta 4 the faces overlap by 1 % of it."""
    if shutil.which("ccx") is None:
        pytest.skip("CalculiX is not installed: make test-hosts")
    found, ours, *means = table.beside_calculix(0.25)
    assert found == pytest.approx(ours, rel=0.01) and found == pytest.approx(-7 / 3, rel=0.01)
    assert means == pytest.approx([1.0, 1.0], rel=0.01)


def test_the_book_counts_the_glue_of_these_files():
    rows = list(csv.reader(table.BOOK.read_text().splitlines()))
    assert rows[0] == table.HEAD
    glue = {name: str(table.glue(host)) for host, name in table.HOSTS.items()}
    assert {(row[0].split()[0], row[1]) for row in rows[1:]} == set(glue.items())
