"""The short form of the stability laboratory: every case once, small; each row ends as its case expects."""

import importlib
import warnings
from dataclasses import replace

import animals
import cases
import folding
import impacts
import inside
import lab
import numpy as np
import pytest
import rest
import run as laboratory
import shapes
import stage as stages
import zoo
from libcontact.checks import warned
from scenes import box_of, scene_with

# Runs warn of intended features of the cases, and of a penalty that chatters. None is "thin": restitution is 1.
MEANT = {"sizes": {"units"}, "contact_and_reference": set()}


@pytest.mark.parametrize("case", cases.CASES, ids=lambda case: case.__name__)
def test_case(case, monkeypatch):
    """Each row ends as its case expects; in two of the pairs a gap beside an edge must not jump (eq:beside-gap)."""
    found = set()

    def classify(name, made, **more):
        found.update(one.kind for one in warned.known(made._built(None), None))
        return lab.classify(name, made, **more)

    monkeypatch.setattr(cases, "classify", classify)
    odd = laboratory.surprises(list(case(True)))
    assert not odd, "\n".join(lab.line(row) for row in odd)
    assert found - {"chatter"} == MEANT.get(case.__name__, set())


def test_a_rolled_strip_gains_by_the_leapfrog_not_by_its_contact():
    """The contact of a neo-Hookean strip never gives more than it took, in any record (eq:impact-reserve). The books of
    the solid, which close in an exact motion, gain .6 % of the work at .9 of the step and nothing at .6."""
    bricks = shapes.spiral(0.25, 0.12, 2.5, 0.05, (64, 1, 1), 0.05)
    for fraction in (0.6, 0.9):
        made, end = folding.pressed(bricks, 0.4, 0.4)
        made.set_time(end=end, fraction=fraction).set_output(every=1, fields=[])
        with lab.booked() as books:
            run = made.run(output=False)
        contact, solid = np.array(books).T / np.abs(run.energy["external"]).max()
        assert lab.rise(contact) < 1e-12
        assert ((solid - solid[0]).max() > folding.GROWTH) == (fraction == 0.9)


@pytest.mark.parametrize("fraction", [0.3, 0.6])
def test_a_ring_folded_flat_does_not_pass_through_itself(fraction):
    """(eq:self-adjacent, eq:step-quotient). A thin ring that is crushed fast folds flat along edges of its mesh, and
    elements there are crushed to a tenth: neighbours do not pass through each other, and no element is inverted, as
    the step is divided where the element is crushed."""
    made, end = folding.pressed(shapes.ring(0.4, 0.05, (40, 1, 1), 0.06), 0.38, 0.38 / 3.0)
    made.set_time(end=end, fraction=fraction).set_output(every=1, fields=[])
    with warnings.catch_warnings(), lab.booked() as books:
        warnings.simplefilter("ignore")
        fold = folding.Fold("body")
        run = made.run(progress=False, output=False, watch=fold)
    work = np.abs(run.energy["external"]).max()
    assert fold.twice == 0
    assert lab.rise(np.array(books)[:, 0]) < 1e-9 * work
    assert (lab.own_energy(run.energy) - run.energy["total"][0]).max() <= folding.GROWTH * work


def test_a_fold_gains_by_the_leapfrog_and_its_division():
    """A fold whose step is divided: its contact neither makes nor loses energy, so the verdict names the leapfrog, and
    as the run warns and half its step gains nothing it is told. A law that made some is told from it
    (eq:divided-energy, eq:divided-work)."""
    _, bricks, drive, *values = folding.strips()[1]
    made, end = drive(bricks, *values)
    row = folding.folded("fold", made, 0.9, end)
    assert row.made < 1e-12 and row.told and laboratory.as_expected(row), lab.line(row)
    assert not row.good and laboratory.summarise([row])[0]["told"] == "1"
    assert lab.is_told(row.warned, row.made, lambda: lab.GROWTH)
    assert not lab.is_told("volume", row.made, float)
    assert not lab.is_told(row.warned, 2 * lab.MADE, float)
    assert not lab.is_told(row.warned, row.made, lambda: 2 * lab.GROWTH)
    made = replace(row, verdict="energy grows by 3 % of the work", made=1e-3)
    assert lab.caused(made) == made.verdict
    assert lab.caused(replace(made, made=0.0)) == "the leapfrog gains 3 % of the work"
    mixed = replace(made, made=0.0, verdict=f"{made.verdict}; 2 nodes are inside another part")
    assert lab.caused(mixed) == mixed.verdict
    assert not laboratory.as_expected(replace(row, expected="passes"))


def test_the_judge_sees_what_is_wrong():
    """Rows with one fault each."""
    good = dict(
        case="",
        enforcement=lab.DEFAULT,
        beta=1.0,
        courant=0.5,
        fraction=0.5,
        steps=1,
        energy=0.0,
        lost=0.0,
        points=0.1,
        nodes=0.1,
        momentum=0.0,
        verdict="",
    )
    assert lab.verdict(lab.Row(**good), 1e-12, 0.5) == ""
    for key, value, word in (
        ("energy", 0.011, "grows"),
        ("lost", 0.011, "is lost"),
        ("momentum", 2e-12, "momentum"),
        ("nodes", 0.6, "penetration"),
        ("points", 0.6, "penetration"),
        ("energy", np.nan, "finite"),
    ):
        assert word in lab.verdict(lab.Row(**good | {key: value}), 1e-12, 0.5)
    assert lab.verdict(lab.Row(**good | {"lost": 0.5, "may_lose": None}), 1e-12, 0.5) == ""


def test_the_laboratory_sees_what_an_impact_loses():
    """Plates of one layer with restitution 0 lose 68 % of their energy (eq:impact-reserve), with 1 nothing."""
    for law, lost in ((impacts.ELASTIC, 0.0), (impacts.PLASTIC, 0.68)):
        made = impacts.equal(1)(law, 0.9, 0.3).made
        row = lab.classify("plates", made, enforcement=lab.DEFAULT, beta=None)
        assert abs(row.lost - lost) < 0.03
        assert ("is lost" in row.verdict) == (lost > 0) and row.held < 1e-12


@pytest.mark.parametrize(("layers", "held"), [("1", 1e-12), ("1, 4:5:4", 1e-3), ("2", 1e-12)])
def test_a_plate_passes_its_impact_on_to_a_third_one(layers, held):
    """A plate hits two that touch: what the first contact holds comes back while the force of the second one lasts,
    so the speeds are in the range of explicit penalties at a tiny step (:eq:`release-together`). A plate of one layer
    in the middle is known as such, and opens in time, also if edges along its faces are shorter
    (:eq:`release-passed`)."""
    case = next(case for case in impacts.unlike() if case.name == f"cradle of {layers}")
    row = impacts.measured(replace(case, phases=(0.0, 0.3, 0.7)), 0.9, case.reference())
    assert row["short"] == "" and row["held"] < held, row


def test_the_table_of_impacts_sees_what_is_short(monkeypatch):
    """A law that loses, speeds beside the range of explicit penalties, and what bodies that touch still hold."""
    case = impacts.Case("plates of 1, short", impacts.equal(1), 0.02, 0.12, 0.12, (0.3,))
    reference = case.reference()
    assert impacts.measured(case, 0.9, reference)["short"] == ""
    beside = impacts.measured(case, 0.9, [reference[0] * 0.5, reference[0] * 0.6])
    assert beside["off"] > 0.2 and "speed" in beside["short"]
    monkeypatch.setattr(impacts, "ELASTIC", impacts.PLASTIC)
    row = impacts.measured(case, 0.9, reference)
    assert "loses" in row["short"]
    held = {**row, "taken": 0.0, "held": 0.5, "off": 0.0}
    closed = impacts.Case("", case.maker, 0.02, closed=True)
    assert impacts.faults(closed, held) == "" and "loses" in impacts.faults(case, held)
    (line,) = impacts.summary([row, {**row, "lost": 0.9}])
    assert line["case"] == "plates of 1" and line["lost, %"] == "90" and line["short"] == "2"


def test_solid_angles_tell_who_is_inside():
    """Points around a re-entrant corner of a concave body, and a hairpin whose legs are moved into each other by three
    quarters of their thickness, or only until they touch."""
    for bricks in (
        shapes.cubes(shapes.CONCAVE["U"]),
        shapes.with_edges(shapes.cubes(shapes.CONCAVE["U"], 2)),
    ):
        points = np.array([[1.5, 0.5, 0.5], [1.5, 1.5, 0.5], [0.5, 2.9, 0.5], [0.5, 3.1, 0.5]])
        assert list(inside.within(points, *bricks)) == [True, False, True, False]
    nodes, elements = shapes.hairpin(0.6, 0.1, 0.08, (18, 2, 2), 0.2)
    for way, corners in ((0.08, False), (0.155, True)):
        moved = nodes - [0, 0, way] * (nodes[:, 2:] > 0)
        assert (inside.twice(moved, elements, 0.8) > 10) == corners


def test_the_smallest_jacobian_of_a_brick():
    """A box has that of its sides; a corner that is moved onto the opposite diagonal plane has none."""
    for bricks in (
        shapes.box((1, 2, 3), (2, 1, 1)),
        shapes.with_edges(shapes.box((1, 2, 3), (2, 1, 1))),
    ):
        assert shapes.least_jacobian(bricks) == pytest.approx(0.5 * 2 * 3 / 8, rel=1e-12)
    nodes, elements = shapes.box((1, 1, 1), (1, 1, 1))
    corner = np.flatnonzero((nodes == 0.5).all(1))
    assert shapes.least_jacobian(
        (np.where(np.arange(8)[:, None] == corner, 1 / 6, nodes), elements)
    ) == pytest.approx(0.0, abs=1e-12)


def test_the_table_is_written(tmp_path, capsys):
    rows = laboratory.collect(["rounding_modes"], True)
    laboratory.write(rows, tmp_path)
    assert len(rows) == 4 and "rounding up" in capsys.readouterr().out
    assert (
        len((tmp_path / "stability.csv").read_text().splitlines()) == 5
        and (tmp_path / "stability.json").exists()
    )


@pytest.mark.parametrize(
    "name, wrong",
    [
        ("run", []),
        ("zoo", ["folder", "part_on_a_flor"]),
        ("impacts", ["plat"]),
        ("laws", ["book"]),
        ("tolerance", []),
        ("kill", ["many"]),
        ("dissipation", ["x"]),
        ("steps", ["--steps", "x"]),
    ],
)
def test_programs_tell_their_arguments(name, wrong, monkeypatch, capsys):
    """Before anything is run."""
    program = importlib.import_module(name)
    for arguments, code, told in ((["--help"], 0, 0), (wrong, 2, 1)):
        monkeypatch.setattr("sys.argv", [f"{name}.py", *arguments])
        with pytest.raises(SystemExit) as end:
            program.main()
        assert end.value.code == code and capsys.readouterr()[told].startswith(f"usage: {name}.py")


def test_watch_sees_every_record_and_impulses_are_the_change_of_momentum():
    scene = scene_with("m", young=1e3, poisson=0.2, density=1.0, title="fall")
    scene.add_body(
        "block", box=box_of([0, 0, 0.01], [1, 1, 1], [2, 2, 2]), material="m", velocity=[0.5, 0, -1]
    )
    scene.add("gravity", acceleration=[0, 0, -10]).add(
        "obstacle",
        surface="block.z_min",
        plane={"point": [0, 0, 0], "normal": [0, 0, 1]},
        friction=0.3,
    )
    scene.add_support("block.y_min", fix="y").set_time(end=0.1, fraction=0.5).set_output(every=3)
    seen = []
    run = scene.run(
        watch=lambda now: seen.append(
            (now.time[-1], now.state["block"].positions[:, 2].min(), len(now.energy))
        )
    )
    assert [time for time, _, _ in seen] == list(run.time) and {rows for _, _, rows in seen} == {1}
    assert (
        seen[0][1] == pytest.approx(0.01)
        and seen[-1][1] == run.state["block"].positions[:, 2].min()
    )
    assert set(run.impulse) == {"gravity", "obstacle", "friction", "support"}
    np.testing.assert_allclose(
        sum(run.impulse.values()), run.momentum["p"][-1] - run.momentum["p"][0], atol=1e-13
    )
    assert run.impulse["gravity"][2] == pytest.approx(-10 * 0.1, rel=1e-12)


# The zoo: each scene at the defaults, each oracle once.


@pytest.mark.parametrize("scene", animals.ANIMALS, ids=lambda scene: scene.__name__)
def test_everyday_scene(scene):
    row = zoo.judge(scene, animals.Options(), whole=False)
    assert row.verdict == "ok", zoo.line(row)


@pytest.mark.parametrize(
    "scene, oracle",
    [
        ("drop_on_a_face", "held"),
        ("thin_plates", "outer"),
        ("closed_impact", "tiny"),
        ("stack", "same"),
    ],
)
def test_oracle_agrees(scene, oracle):
    row = zoo.judge(getattr(animals, scene), animals.Options(), whole=True)
    assert row.verdict == "ok" and getattr(row, oracle) >= 0, zoo.line(row)


@pytest.mark.parametrize("integrator", animals.INTEGRATORS)
@pytest.mark.parametrize("scene", ["ball_in_a_cup", "thin_plates"])
def test_bodies_gain_nothing_with_any_integrator(scene, integrator):
    """Also if contacts give back what they hold, although the default is 0 with these integrators. With the method of
    Noh and Bathe a force that acts in one stage of a step and not in the other makes energy in the solid. The ball
    gained while points that came near were reflected by a reserve of next to nothing, the plates while points opened
    one by one; they open together now, and only with more than their motion has (:eq:`release-time`)."""
    options = animals.Options(integrator=integrator)
    animal = getattr(animals, scene)(options)
    for law in (animal.stage.law, animal.stage.law | {"restitution": 1.0}):
        given = zoo.replace(animal.stage, law=law)
        assert zoo.growth(options, animal, zoo.play(given, scene).run) < 1e-9


@pytest.mark.parametrize("seed", [8, 168, 292, 300])
def test_friction_adds_no_energy_where_surfaces_just_touch(seed):
    """Before the load begins points move by rounding along the plane; that is no slip that could cut the allowed
    forces, :eq:`slip-set`, by a line across the plane."""
    _, scene, _ = rest.rest_scene(seed)
    scene._data["obstacle"][0]["friction"] = 0.5
    energy = scene.set_output(every=1, fields=[]).run(progress=False, output=False).energy
    assert energy["total"].max() < 1e-12 * energy["external"].max()


def test_points_that_leave_over_a_border_hand_on_what_they_hold():
    """(eq:impact-left). With open faces of hex20 eight points lose their partner while they press, and kept 5 % of the
    energy for good. What the contact books neither rises nor falls, and swapped surfaces give the same bits."""
    stage = animals.open_faces(animals.Options(element="hex20")).stage
    ends = []
    for form in (stage, stages.swapped(stage)):
        made = form.scene("open").set_time(**form.time, force_tolerance=1e-12)
        with lab.booked() as books:
            run = made.set_output(every=1, fields=[]).run(output=False)
        total, held = run.energy["total"][0], run.energy["reserve"]
        assert np.abs(np.array(books)[:, 0]).max() < 1e-12 * total
        assert held.max() > 0.05 * total and held[-1] < 1e-9 * total
        ends.append([run.state[name].displacement.tobytes() for name in stage.parts])
    assert ends[0] == ends[1]


def test_growth_of_the_leapfrog_is_told_not_failed():
    """(eq:step-resonance). A run that does not say so fails, and so does one whose contact makes it."""
    options = animals.Options(fraction=0.99)
    animal = animals.swing(options)
    own = zoo.play(animal.stage, "swing")
    for change, verdict in ({}, "told"), ({"warned": ""}, "FAIL"), ({"made": animal.scale}, "FAIL"):
        row = zoo.Row("swing", str(options))
        zoo.weigh(row, animal, zoo.replace(own, **change), options)
        assert row.verdict == verdict and row.growth > zoo.GROWTH, zoo.line(row)


def test_a_twin_is_another_answer_only_if_more_landings_say_so(monkeypatch):
    """Six landings of a rattling stack seem to tell named faces from whole skins, by 2.04 %; seventeen do not. They do
    tell a stack of hardly any weight."""
    options = animals.Options(beta=3e3)
    animal = animals.stack(options)
    own = zoo.play(animal.stage, "stack")
    light = lambda stage: zoo.replace(stage, gravity=tuple(0.01 * g for g in stage.gravity))
    for forms, verdict in ((stages.outer,), "ok"), ((light,), "FAIL"):
        monkeypatch.setattr(zoo, "TWINS", {"outer": forms})
        row = zoo.Row("stack", str(options))
        zoo.compare_twins(row, animal, own, options)
        assert row.verdict == verdict and row.sensitive == "outer", zoo.line(row)


def test_growth_after_a_loss_is_told():
    """(eq:growth-again). A fold at .9 of its step loses 2.5 % of the work by the leapfrog and gains 2.7 %, so it never
    has .2 % more than at its start. Half the step, which the warning names, hardly gains."""
    _, bricks, drive, *values = next(one for one in folding.strips() if one[0] == "wide gap slow")
    for fraction, told in (0.9, True), (0.45, False):
        made, end = drive(bricks, *values)
        made.set_time(end=end, fraction=fraction).set_output(every=1, fields=[])
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            energy = made.run(progress=False, output=False).energy
        work = np.abs(energy["external"]).max()
        assert (lab.own_energy(energy) - energy["total"][0]).max() < 0.002 * work
        assert (lab.rise(energy["total"] / work) > 0.02) is told
        found = [one.message for one in caught if lab.kinds([one]) == "energy_growth"]
        assert [(one.who, 0.01 < one.ratio < 0.02) for one in found] == [
            ('body "body"', True)
        ] * told
        assert all("fraction = 0.45" in str(one) for one in found)


def test_means_of_samples_of_different_size():
    """The squared standard error of a difference is the sum of those of both samples."""
    one, two = [0.0, 1.0, 2.0, 3.0], [9.0, 11.0]
    error = (5 / 3 / 4 + 2 / 2) ** 0.5
    assert zoo.apart(one, two) == pytest.approx(8.5 - zoo.ERRORS * error, rel=1e-12)
    assert zoo.apart([1.0], [3.0]) == 2.0


def test_several_twins_give_a_range():
    """A mean between theirs agrees, one outside differs by its distance."""
    assert [zoo.apart([x], [3.0], [0.0], [1.0]) for x in (2.0, -1.0, 3.5)] == [0.0, 1.0, 0.5]
    both = [np.array([4.0, 1.0])], [np.array([3.0, 0.0])], [np.array([2.0, 2.0])]
    assert zoo.apart(*both) == 1.0


def test_momentum_over_a_border_is_no_difference_of_skins():
    """Points of the open faces that meet the sides of the other body, which only its skin has: here they exchange a
    tenth of the momentum, and with hex8 nothing. Where nothing is exchanged, nothing comes on top."""
    answers = []
    for element in ("hex8", "hex20"):
        animal = animals.open_faces(animals.Options(element=element))
        named = animal.stage.touches
        answers.append(zoo.play(stages.outer(animal.stage), element, named))
    assert answers[0].aside == 0.0 and not answers[1].beside
    share = 0.5 * answers[1].aside * animal.speed / animal.scale
    assert share == pytest.approx(0.1, rel=0.1)
    names = list(animal.stage.parts)
    change = answers[1].run.body_momentum("top")["p"]
    assert answers[1].aside < np.linalg.norm(change[-1] - change[0]) and names == ["low", "top"]
    pair = [zoo.play(animal.stage, "open")], [answers[1]]
    alone, what = zoo.difference("outer", animal, *pair)
    assert alone > 1 and "bounce" in what
    assert zoo.difference("outer", animal, *pair, aside=share)[0] < 1


def test_a_soft_penalty_lets_a_small_ball_in_with_any_law():
    """A depth beyond the scene's own limit needs the explicit law to be as deep, and the limit of all scenes holds."""
    options = animals.Options(beta=1.0, size=0.7)
    animal = animals.small_sphere(options)
    explicit = zoo.play(zoo.tiny(animal.stage, beta=1.0), "explicit").depth
    for depth, yields in (0.99 * explicit, True), (1.01 * explicit, False):
        row = zoo.Row("small_sphere", str(options), depth=depth)
        assert zoo.yields(row, animal, options) == yields
    assert not zoo.yields(zoo.Row("", "", depth=0.51), animal, options)


def judged(stage, **more):
    """The row of a scene with one fault."""

    def faulty(o):
        return zoo.replace(animals.drop_on_a_face(o), stage=stage, **more)

    faulty.__name__ = "faulty"
    return zoo.judge(faulty, animals.Options(), whole=False)


def test_the_oracles_see_what_is_wrong():
    """A scene with one fault each: an answer that depends on the body's name, a wall that only obstacles have, a speed
    that comes from nothing, a body that falls through."""
    good = animals.drop_on_a_face(animals.Options()).stage
    assert judged(good).verdict == "ok"
    wall = good.walls[0]
    through = zoo.replace(good, walls=(zoo.replace(wall, point=(0.0, 0.0, -9.0)),))
    row = judged(through, overlap=0.0, apart=(("cube", "cube", (0, 0, 1)),))
    assert row.verdict == "FAIL" and "passed" in row.reason
    own = zoo.play(good, "good")
    own.run.energy["kinetic"][-1] *= 2
    row = zoo.Row("faulty", "")
    zoo.weigh(row, animals.drop_on_a_face(animals.Options()), own, animals.Options())
    assert "energy grows" in row.reason
    row = zoo.Row("faulty", "")
    faster = stages.Part(**{**good.parts["cube"].__dict__, "velocity": (0, 0, -8.0)})
    other = zoo.play(zoo.replace(good, parts={"cube": faster}), "faster")
    animal = animals.drop_on_a_face(animals.Options())
    assert zoo.difference("held", animal, [zoo.play(good, "good")], [other])[0] > 1
    # Six like landings know their mean, six unlike ones only to three standard errors.
    assert zoo.apart([1.0] * 6, [2.0] * 6) == zoo.apart([1.0], [2.0]) == 1.0
    error = np.sqrt(2 * np.var([0.0, 1.0] * 3, ddof=1) / 6)
    assert zoo.apart([0.0, 1.0] * 3, [0.5, 1.5] * 3) == 0.0
    assert zoo.apart([0.0, 1.0] * 3, [3.0, 4.0] * 3) == pytest.approx(3.0 - 3.0 * error)


@pytest.mark.parametrize("scene, bulges", [("fast_soft", True), ("thin_plates", False)])
def test_the_zoo_sees_which_faces_touch(scene, bulges):
    """A soft body with a soft penalty bulges onto its sides, which its named faces do not know."""
    stage = getattr(animals, scene)(animals.Options(beta=1.0)).stage
    assert zoo.play(stages.outer(stage), scene, stage.touches).beside is bulges


def test_a_scene_that_is_turned_and_mirrored_back_is_the_same():
    stage = animals.incline(animals.Options(element="hex20")).stage
    R = np.eye(3)[[1, 2, 0]]
    back = stages.turned(stages.turned(stage, R), R.T)
    for one in (
        back,
        stages.mirrored(stages.mirrored(stage)),
        stages.reordered(stages.reordered(stage)),
    ):
        for name, part in stage.parts.items():
            assert np.array_equal(one.parts[name].bricks[0], part.bricks[0])
            assert np.array_equal(one.parts[name].bricks[1], part.bricks[1])
        assert one.walls == stage.walls and one.gravity == stage.gravity
    for form in (stages.mirrored(stage), stages.turned(stage, R)):
        assert shapes.least_jacobian(form.parts["block"].bricks) > 0


@pytest.mark.parametrize("animal", [animals.thin_plates, animals.stack])
def test_what_just_touches_turns_with_its_scene(animal):
    """Some points of turned plates touch a step before the others by rounding, and then opened a step before them
    (eq:release-time). A point of a turned stack opened again with what the solver's tolerance had left of its reserve,
    which changed what all others gave back (eq:release-ramp)."""
    options = animals.Options(way=1)
    row = zoo.Row(animal.__name__, str(options))
    zoo.compare_forms(row, animal(options))
    assert row.same <= zoo.SAME and not row.reason


def test_the_zoo_goes_on_where_it_stopped(tmp_path, monkeypatch):
    path = tmp_path / "zoo.jsonl"
    few = [(animals.incline, animals.Options()), (animals.swing, animals.Options())]
    monkeypatch.setattr(zoo, "runs", lambda draws: iter(few[:1]))
    first = zoo.collect(path, 0, [])
    monkeypatch.setattr(zoo, "runs", lambda draws: iter(few))
    both = zoo.collect(path, 0, [])
    assert len(first) == 1 and len(both) == 2 and both[0] == first[0]
    assert [line["scene"] for line in zoo.summarise(both)] == ["incline", "swing"]
