"""Pictures of runs: what is shown by default, from where, with which colours; and the states that they are drawn
from."""

import copy

import numpy as np
import pytest
from libcontact.state import mises, principal
from scenes import box_of, scene_with

import libcontact as ct

pytest.importorskip("matplotlib")
from libcontact.pictures.drawing import Drawing  # noqa: E402
from libcontact.pictures.faces import Faces, _shape  # noqa: E402
from libcontact.pictures.picture import bar_axis, chosen, draw_energies, plot_run  # noqa: E402
from matplotlib.backends.backend_agg import FigureCanvasAgg  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402

needs_hdf5 = pytest.mark.skipif(not ct.has("hdf5"), reason="built without HDF5")


@pytest.fixture(scope="module")
def hertz():
    data = ct.Scene.load(ct.example("hertz")).data
    data["body"][0]["box"]["cells"] = [8, 8, 8]
    return ct.Scene(data).run()


def falling(**material):
    """A block that falls on a held plate."""
    scene = scene_with(
        "rubber", young=1e6, poisson=0.3, density=1000, **material, title="Falling block"
    )
    plate = box_of([-1, -1, -0.4], [2, 2, 0.4], [10, 10, 2])
    block = box_of([-0.3, -0.3, 0.02], [0.6, 0.6, 0.6], [2, 2, 2])
    scene.add_body("plate", box=plate, material="rubber")
    scene.add_body("block", box=block, material="rubber", velocity=[0, 0, -4])
    scene.add_contact("block.z_min", "plate.z_max")
    scene.add_support("plate.z_min", fix=["x", "y", "z"])
    return scene.set_time(end=0.04, fraction=0.2)


@pytest.fixture(scope="module")
def block():
    return falling().run()


def shown(run, **options):
    figure = plot_run(run, figure=Figure(), **options)
    FigureCanvasAgg(figure).draw()
    return figure


def test_instants_and_energies_have_one_unit_of_time(block):
    """The run lasts 0.04 s."""
    figure = shown(block)
    titles = {axes.get_title().split()[-1] for axes in figure.axes if axes.get_title()}
    (energies,) = (axes for axes in figure.axes if axes.get_ylabel().startswith("energy"))
    assert titles == {"ms"} and energies.get_xlabel() == "t [ms]"
    assert energies.lines[-1].get_xdata()[-1] == pytest.approx(40.0)


def test_colours_have_readable_units(block):
    """A stress of 1e5 Pa is shown in kPa, without a power of ten beside the axis."""
    figure = shown(block, field="mises")
    (bar,) = (axes for axes in figure.axes if "von Mises" in axes.get_xlabel())
    assert bar.get_xlabel() == "von Mises stress [kPa]"
    assert not bar.xaxis.get_offset_text().get_text()
    for tick, place in zip(bar.get_xticklabels(), bar.get_xticks()):
        assert 1e3 * float(tick.get_text()) == pytest.approx(place)


def test_curves_that_cannot_be_seen_are_not_named(block):
    """Nor does a part stand above the whole: the first row of what is held is that of half a step later."""
    run = copy.copy(block)
    run.energy = block.energy.copy()
    run.energy["external"] = 1e-3 * run.energy["kinetic"].max()
    run.energy["reserve"][0] = 2.0 * run.energy["contact"].max()
    axes = Figure().subplots()
    draw_energies(axes, run)
    lines = {line.get_label(): line.get_ydata() for line in axes.lines}
    assert "external" not in lines and (lines["reserve"] <= lines["contact"]).all()
    # What covers another line is dotted and above it, so that both are seen.
    front = max(axes.lines, key=lambda line: line.get_zorder())
    assert front.get_label() == "reserve" and front.get_linestyle() == ":"
    assert lines["kinetic"].max() == run.energy["kinetic"].max()


def test_nine_energies_are_named_in_two_rows():
    scene = falling().add("gravity", acceleration=[0, 0, -9.81]).add("damping", rate=1.0)
    figure = shown(scene.add("viscosity", linear=0.1).run())
    (names,) = (axes.get_legend().get_texts() for axes in figure.axes if axes.get_legend())
    heights = sorted(name.get_window_extent().y0 for name in names)
    assert len(heights) == 9 and np.flatnonzero(np.diff(heights) > 8).tolist() == [3]


# Fields.


def test_derived_stresses_are_those_of_a_rotated_stress():
    """Mises, principal stresses and pressure do not depend on the axes; their values for a known diagonal."""
    rng = np.random.default_rng(1)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    tensor = turn @ np.diag([3.0, -1.0, 2.0]) @ turn.T
    stress = np.array([tensor[i] for i in [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)]])[None]
    assert principal(stress)[0] == pytest.approx([-1.0, 2.0, 3.0])
    # ((3+1)² + (1+2)² + (2-3)²)/2
    assert mises(stress)[0] == pytest.approx(np.sqrt((16 + 9 + 1) / 2))
    assert mises(np.array([[0, 0, 0, 2.0, 0, 0]]))[0] == pytest.approx(2.0 * np.sqrt(3.0))


def test_a_body_has_the_derived_components(block):
    body = block.state["block"]
    for name, expected in {
        "mises": mises(body.stress),
        "pressure": -body.stress[:, :3].sum(axis=1) / 3,
        "principal_max": principal(body.stress)[:, 2],
        "principal_min": principal(body.stress)[:, 0],
        "velocity_magnitude": np.linalg.norm(body.velocity, axis=1),
        "displacement_magnitude": np.linalg.norm(body.displacement, axis=1),
    }.items():
        values, at_elements = body.component(name)
        assert np.allclose(values, expected) and at_elements == (len(values) == len(body.elements))
    _, line = block.line("mises", (0, 0, 0.1), (0, 0, 0.5), 3, body="block")
    assert np.isfinite(line).all()


# States.


def test_a_run_without_a_file_keeps_its_states(block):
    """As many as records, each with the values of its own time; the last one is the state of the run."""
    states = block.states
    assert len(states) == len(block.steps) and [s.step for s in states] == block.steps.tolist()
    kinetic = [
        sum(float((s[b].velocity ** 2).sum()) for b in block.bodies)
        for s in (states[0], states[-1])
    ]
    assert kinetic[0] > kinetic[1] > 0.0
    assert np.array_equal(states[-1]["block"].displacement, block.state["block"].displacement)
    assert not states[0]["block"].displacement.any()
    assert max(float(s["block"].contact_pressure.max()) for s in states) > 0.0


def test_a_run_that_fails_can_be_drawn():
    """The states up to the last good one."""
    scene = scene_with("rubber", young=1e6, poisson=0.3, density=1000)
    box = box_of([0, 0, 0], [1, 1, 1], [2, 2, 2])
    scene.add_body("block", box=box, material="rubber", velocity=[0, 0, 1])
    scene.add_effect(
        "push", "block", "z_max", lambda view: np.full((9, 3), np.nan if view.time > 0.3 else 1.0)
    )
    with pytest.raises(ct.RunError) as error:
        scene.set_time(end=1.0).run()
    run = error.value.run
    assert run.states[-1] is run.state and Drawing.of(run).view


def test_a_large_run_keeps_fewer_states(monkeypatch):
    monkeypatch.setattr("libcontact.loop.KEPT_VALUES", 7 * 390 * 5)
    run = falling().run()
    assert 3 <= len(run.states) <= 7 < len(run.steps)
    assert run.states[-1].step == run.steps[-1]


@needs_hdf5
def test_the_states_of_a_file_are_those_that_were_recorded(tmp_path, block):
    run = falling().run(output=tmp_path / "run.vtkhdf")
    loaded = ct.Run.load(tmp_path / "run.vtkhdf")
    for states in (run.states, loaded.states):
        assert [s.step for s in states] == block.steps.tolist()
        assert len({id(mesh) for mesh in [s["block"].mesh for s in states]}) == 1
        for one, other in zip(states[::5], block.states[::5]):
            assert np.array_equal(one["block"].displacement, other["block"].displacement)
    with pytest.raises(IndexError):
        run.states[len(run.states)]


# What is shown.


def test_hertz_shows_the_contact_pressure_from_the_corner_under_the_sphere(hertz):
    """The sphere presses on the corner x = y = 0 of z_max: the sides x_min, y_min and z_max meet there."""
    drawing = Drawing.of(hertz)
    assert drawing.field == "contact_pressure"
    assert set(drawing.view.split("+")) == {"x_min", "y_min", "z_max"}
    pressure = hertz.states[-1]["block"].contact_pressure
    assert drawing.limits[0] == 0.0 and 0.7 * pressure.max() < drawing.limits[1] <= pressure.max()
    bars = [axes for axes in shown(hertz).findobj(match=lambda a: hasattr(a, "_colorbar"))]
    labels = {axes.get_xlabel() for axes in bars}
    assert labels == {"contact pressure [MPa]", "von Mises stress [MPa]"}


def test_the_pressure_under_the_sphere_is_seen(hertz):
    figure = shown(hertz)
    pixels = np.asarray(figure.canvas.buffer_rgba())[:, :, :3].astype(int)
    red = (pixels[..., 0] > 100) & (pixels[..., 1] < 60) & (pixels[..., 2] < 80)
    assert red.sum() > 50


def test_colours_reach_over_the_visible_faces_only(hertz):
    """On the far side of the block nothing is loaded: the range is that of its faces, not of the hidden ones."""
    near = Drawing.of(hertz, "mises", "z_max")
    far = Drawing.of(hertz, "mises", "x_max+y_max+z_min")
    stress, mesh = mises(hertz.state["block"].stress), hertz.state["block"].mesh
    owners = np.concatenate([mesh.faces(name)[1] for name in ("x_max", "y_max", "z_min")])
    assert near.limits[1] == stress[mesh.faces("z_max")[1]].max()
    assert far.limits[1] == stress[owners].max() < 0.2 * near.limits[1]


def test_a_covered_face_gives_no_colour(block):
    """The plate's faces under the block are turned to the viewer, and covered."""
    at = min(block.states, key=lambda s: s["block"].positions[:, 2].min())
    drawing = Drawing.of(block, "mises", "z_max", scale=0.0, states=[at])
    faces = Faces.of(drawing, at)
    assert len(faces.values) == 4 + 100 and (faces.shown() > 0).sum() == 4 + 100 - 4
    below = Drawing.of(block, "mises", "z_min", scale=0.0, states=[at])
    assert (Faces.of(below, at).shown() > 0.9).sum() == 100


def test_a_block_on_a_plate_is_three_dimensional_with_the_block_in_front(block):
    figure = shown(block)
    drawing = Drawing.of(block, states=chosen(block, 4))
    assert drawing.field == "mises" and drawing.view.count("+") == 2 and "z_max" in drawing.view
    titles = [axes.get_title() for axes in figure.axes if axes.get_title()]
    assert len(titles) == 4 and titles[0] == "t = 0 ms" and titles[-1] == "t = 40 ms"
    # The block is drawn after the plate, whose larger faces reach closer to the viewer.
    at = block.states[-1]
    order = Faces.of(drawing, at)
    heights = order.outlines.reshape(len(order.outlines), -1, 2)
    block_faces = Faces.of(drawing, type(at)(at.time, at.step, {"block": at["block"]}))
    assert np.allclose(heights[-len(block_faces.outlines) :], block_faces.outlines)


def test_one_of_the_instants_is_that_of_the_hardest_contact(block):
    energy = block.energy["contact"]
    times = [state.time for state in chosen(block, 4)]
    assert len(times) == 4 and block.time[energy.argmax()] in times
    assert [s.time for s in chosen(block, 1)] == [block.time[-1]]


def test_a_flat_scene_is_seen_along_its_thickness_with_the_stress_of_the_impact():
    data = ct.Scene.load(ct.example("plates")).data
    for body in data["body"]:
        body["box"]["cells"] = [10, 1, 10]
    run = ct.Scene(data).run(output=False)
    drawing = Drawing.of(run)
    assert (drawing.view, drawing.field, drawing.scale) == ("y_min", "stress_xx", 1.0)
    assert drawing.limits[0] == -drawing.limits[1]


def test_a_thin_plate_that_bends_is_not_flat():
    """Seen from above, a plate that bends would be squares of colours."""
    scene = scene_with("rubber", young=1e6, poisson=0.3, density=1000)
    box = box_of([0, 0, 0], [1, 1, 0.05], [8, 8, 1])
    scene.add_body("plate", box=box, material="rubber")
    scene.add_support("plate.x_min", fix=["x", "y", "z"])
    scene.add("gravity", acceleration=[0, 0, -10]).set_time(end=0.05)
    drawing = Drawing.of(scene.run())
    assert not drawing.flat and drawing.up == "z" and drawing.field == "mises"


def test_small_displacements_are_magnified_where_nothing_moves_or_touches():
    data = ct.Scene.load(ct.example("cantilever")).data
    data["body"][0]["box"]["cells"] = [8, 2, 2]
    data["load"][0]["traction"] = [0, 0, -0.1]
    run = ct.Scene(data).run(output=False)
    drawing = Drawing.of(run)
    most = np.abs(run.state["beam"].displacement).max()
    assert 0.02 * 100 < drawing.scale * most <= 0.06 * 100 and not drawing.flat
    assert Drawing.of(run, scale=1.0).scale == 1.0


def test_a_bar_is_drawn_over_position_and_time():
    """Stress of -300 behind the front between the impact at t = 0.5 and the rebound at 1.1667."""
    run = ct.Scene.load(ct.example("bar_on_a_wall")).run(output=False)
    assert bar_axis(run) == 0
    figure = shown(run)
    cells = [c.get_array() for axes in figure.axes for c in axes.collections]
    values = max((v for v in cells if v is not None), key=np.size).reshape(len(run.time), 100)
    k = int(np.abs(run.time - 0.8).argmin())
    assert values[k, :20].mean() == pytest.approx(-300.0, rel=0.03)
    assert np.abs(values[: int(np.abs(run.time - 0.4).argmin())]).max() < 1e-6
    assert bar_axis(run) is not None and len(shown(run, view="y_min", instants=2).axes) > 2


def test_views(block):
    """From y_max, x runs to the left; a corner shows the three sides that it names."""
    assert Drawing.of(block, view="y_max").axes[0] == pytest.approx([-1, 0, 0])
    toward = Drawing.of(block, view="x_min+y_max+z_max").toward
    assert (np.sign(toward) == [-1, 1, 1]).all()
    for view in ("above", "x_min+x_max", "x_min+", ""):
        if view:
            with pytest.raises(ValueError, match="view"):
                Drawing.of(block, view=view)
    with pytest.raises(ValueError, match="did you mean"):
        plot_run(block, field="mise", figure=Figure())


def test_an_instant_is_drawn_into_given_axes(block):
    """As for the frames of a film: bounds and colours are those of the drawing for each state."""
    drawing = Drawing.of(block, states=block.states)
    figure = Figure()
    for axes, state in zip(figure.subplots(1, 2), block.states[:: len(block.states) - 1]):
        faces = drawing.draw(axes, state)
        assert faces.get_clim() == drawing.limits
        assert axes.get_xlim() == drawing.bounds[:2] and axes.get_ylim() == drawing.bounds[2:]


def test_shape_functions_of_faces():
    """1 at their node and 0 at the others; linear and, for Q8, quadratic fields are exact."""
    nodes = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [0, -1], [1, 0], [0, 1], [-1, 0]], float)
    for width in (4, 8):
        assert np.allclose(_shape(width, nodes[:width]), np.eye(width))
    xi = np.random.default_rng(2).uniform(-1, 1, (9, 2))
    field = lambda x: 1 + x[:, 0] - 2 * x[:, 1] + x[:, 0] ** 2 * x[:, 1]  # noqa: E731
    assert np.allclose(_shape(8, xi) @ field(nodes), field(xi))


def test_edges_of_hex20_are_drawn_curved():
    """The side of a ring of 8 elements around a full circle: its outlines are polygons of 32 corners, whose area is
    that between the circles times sin(π/16)/(π/16) = 0.9936, less the error of parabolas, 5e-4. Polygons of the 16
    nodes would have 0.974."""
    ring = {"centre": [0, 0, 0], "radius": [0.5, 1.0], "width": 0.2, "cells": [1, 8, 1]}
    scene = ct.Scene(units={"length": "m", "mass": "kg", "time": "s"})
    scene.add_material("soft", young=1.0, poisson=0.3, density=1.0)
    scene.add_body("ring", material="soft", ring=ring, element="hex20")
    run = scene.set_time(end=0.01, fraction=0.5).run()
    at = run.states[-1]
    faces = Faces.of(Drawing.of(run, "mises", "z_max", scale=0.0, states=[at]), at)
    assert faces.outlines.shape[1:] == (16, 2) and len(faces.outlines) == 8
    chords = np.sin(np.pi / 16) / (np.pi / 16)
    assert abs(faces.areas().sum() / (np.pi * 0.75) - chords) < 1e-3


def test_a_long_title_is_in_lines_that_fit(block):
    from matplotlib.text import Text

    words, long = " ".join(["block"] * 60), copy.copy(block)
    long.scene = block.scene.replace('title = "', f'title = "{words} ', 1)
    figure = shown(long)
    figure.canvas.draw()
    text = max(figure.findobj(Text), key=lambda each: len(each.get_text()))
    box = text.get_window_extent()
    assert text.get_text().count("block") >= 60
    assert box.x0 >= 0 and box.x1 <= figure.bbox.width and box.y1 <= figure.bbox.height


def test_the_backend_of_matplotlib_stays(block, monkeypatch):
    import matplotlib

    monkeypatch.setattr(
        matplotlib, "use", lambda *_, **__: pytest.fail("matplotlib.use was called")
    )
    from matplotlib import pyplot

    before = matplotlib.get_backend()
    figure = block.plot(instants=2)
    assert matplotlib.get_backend() == before and pyplot.fignum_exists(figure.number)
    pyplot.close(figure)
