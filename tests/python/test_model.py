"""The model of the scene's keys: its defaults are those of C, its JSON Schema accepts the same scenes as the reader,
and a saved scene is read back unchanged."""

import copy
import inspect
import json
import math
import tomllib
from pathlib import Path

import jsonschema
import libcontact.model as model
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from libcontact._core import ffi, lib
from libcontact.effects import Effect
from libcontact.parts import EFFECTS, MANY, ONCE, Parts, read, schema
from libcontact.planning import explain
from libcontact.schema import Place, SceneError, Table, required
from scenes import METRES

import libcontact as ct

ROOT = Path(__file__).parents[2]
SCENES = sorted((ROOT / "tutorials" / "scenes").glob("*.toml"))
SCHEMA = schema()


def finite(checker, value):
    try:
        number = isinstance(value, (int, float)) and not isinstance(value, bool)
        return number and math.isfinite(value)
    except OverflowError:
        return False


def whole(checker, value):
    return finite(checker, value) and isinstance(value, int)


# TOML distinguishes 2 and 2.0, and has infinities; JSON does not.
Validator = jsonschema.validators.extend(
    jsonschema.Draft202012Validator,
    type_checker=jsonschema.Draft202012Validator.TYPE_CHECKER.redefine_many(
        {"integer": whole, "number": finite}
    ),
)


def by_schema(scene):
    return Validator(SCHEMA).is_valid(scene)


def by_reader(scene):
    """Whether each key is valid alone; the schema does not contain conditions between keys."""
    try:
        Parts.read(scene, Place())
        # Missing bodies or time are detected when the whole scene is read.
        return "time" in scene and bool(scene.get("body"))
    except SceneError:
        return False


# A scene with all tables and almost all keys, so that each can be mutated.
FULL = tomllib.loads("""
title = "all keys"
units = { length = "m", mass = "kg", time = "s" }
material = [{ name = "soft", young = 900.0, poisson = 0.3, density = 1.0, law = "neo_hookean" }, { name = "hard", young = 9000, poisson = 0.3, density = 1 }]
gravity = { acceleration = [0, 0, -9.81], bodies = ["a", "b"], history = { time = [0, 1], value = [0, 1] } }
damping = { rate = 0.5, stiffness = 1e-5, bodies = ["a"] }
viscosity = { linear = 0.1, quadratic = 1.0, bodies = ["a"] }
time = { end = 0.01, fraction = 0.5, integrator = "chung_lee", integrator_parameter = 1.03, stable_step = "elements", force_tolerance = 1e-6, energy_limit = 0.5, look_every = 12 }
output = { file = "all.vtkhdf", fields = ["stress"], every = 3, filter = 0 }
run = { threads = 2, savings = ["quiet", "congruent"] }
probe = [{ name = "p", body = "a", point = [0.5, 0.5, 0.5], quantities = ["stress"], every = 2 }, { name = "q", surface = "b.outer" }, { name = "r", resultant = "support[1]" }]
[[body]]
name = "a"
material = "hard"
box = { origin = [0, 0, 0], size = [1, 1, 1], cells = [2, 2, 2], layers = "x" }
element = "hex8"
lumping = "hrz"
kernel = "auto"
integration = "reduced"
hourglass = 0.5
velocity = [1, 0, 0]
[[body]]
name = "b"
material = "soft"
ring = { centre = [5, 0, 0], radius = [0.5, 1.0], width = 0.5, cells = [1, 8, 1] }
spin = { axis = [0, 0, 1], rate = 3.0, centre = [5, 0, 0] }
initial = { displacement = [0.1, 0, 0], gradient = [[0, 0.01, 0], [0, 0, 0], [0, 0, 0]], angle = 0.5, axis = [1, 0, 0], centre = [5, 0, 0] }
[[body]]
name = "c"
material = "hard"
nodes = [[0, 0, 5], [1, 0, 5], [1, 1, 5], [0, 1, 5], [0, 0, 6], [1, 0, 6], [1, 1, 6], [0, 1, 6]]
elements = [[0, 1, 2, 3, 4, 5, 6, 7]]
sets = { top = { faces = [[0, 5]] }, low = { nodes = [0, 1] }, all = { elements = [0] } }
[[body]]
name = "d"
material = "hard"
box = { origin = [0, 0, 0], size = [1, 1, 1], cells = [1, 1, 1] }
place = { angle = 0.1, axis = [0, 1, 1], centre = [0, 0, 0], move = [0, 0, 9] }
[[body]]
name = "e"
material = "hard"
inertia = { mass = 1, moments = [1, 2, 2], centre = [2, 0, 9] }
[[body]]
name = "f"
material = "hard"
cylinder = { centre = [30, 0, 0], radius = 1, width = 0.5, cells = [1, 8, 1] }
[[body]]
name = "g"
material = "hard"
ball = { centre = [33, 0, 0], radius = 1, cells = [1, 4] }
[[body]]
name = "h"
material = "hard"
shell = { centre = [36, 0, 0], radius = [0.5, 1], cells = [1, 4] }
[[contact]]
surfaces = ["a.x_max", "b.outer"]
epsilon = 100.0
method = "newton"
tolerance = 1e-9
depth = 0.1
friction = 0.2
tangent = 0.5
points = "lobatto"
adjust = 0.01
initial_penetration = "remove"
removal_time = 0.1
enforcement = "energy_controlled"
dissipation = 0.2
restitution = 0.5
[[support]]
set = "a.x_min"
fix = ["x", "y"]
velocity = [1, 0, 0]
[[support]]
set = "a.z_min"
fix = ["z"]
travel = [0, 0, 1]
history = { time = [0, 1], value = [0, 1] }
[[load]]
surface = "a.z_max"
pressure = 1.0
traction = [0, 1, 0]
following = true
history = { time = [0.0], value = [1.0] }
[[absorb]]
surface = "b.z_max"
[[obstacle]]
surface = "a.x_max"
plane = { point = [3, 0, 0], normal = [-1, 0, 0] }
beta = 2
velocity = [0, 0, 1]
travel = [0, 0, 1]
history = { time = [0, 1], value = [0, 1] }
[[obstacle]]
surface = "b.outer"
cylinder = { centre = [9, 0, 0], axis = [0, 0, 1], radius = 1 }
adjust = 0.1
points = "lobatto"
initial_penetration = "remove"
removal_time = 0.5
[[tie]]
surfaces = ["a.y_max", "c.top"]
beta = 50
reach = 9
[[rigid]]
body = "d"
fixed = ["x", "rx"]
[[rigid]]
body = "e"
pivot = [0, 0, 1]
[[rigid]]
set = "c.top"
[[obstacle]]
surface = "c.x_max"
sphere = { centre = [9, 0, 5.5], radius = 1 }
carrier = "e"
""")


def test_the_full_scene_is_one():
    """Otherwise its mutations would prove nothing."""
    assert by_schema(FULL) and by_reader(FULL)
    read(FULL)
    tables = {**MANY, **ONCE}
    there = {key: set() for key in tables}
    for key in tables:
        for table in FULL[key] if key in MANY else [FULL[key]]:
            there[key] |= set(table)
    missing = {
        f"{key}.{name}" for key, table in tables.items() for name in set(table.keys()) - there[key]
    }
    # They replace other keys.
    assert missing == set(
        """
        body.mesh body.part body.scale body.extrude contact.beta damping.relaxation
        obstacle.dissipation obstacle.restitution
        obstacle.enforcement obstacle.epsilon obstacle.friction obstacle.tangent output.times
        time.courant time.dt time.end_c1t_over time.until_static
    """.split()
    )


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_scenes_of_the_tutorials_are_valid(path):
    scene = tomllib.loads(path.read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    Validator(json.loads(json.dumps(SCHEMA))).validate(scene)


# Mutations: the schema and the reader accept the same scenes.

values = st.one_of(
    st.booleans(),
    st.integers(-3, 40),
    st.sampled_from([-1.0, 0.0, 0.3, 0.5, 1.0, 1.5, 2.0, 1e300, math.inf, -math.inf, math.nan]),
    st.sampled_from([2**31 - 1, 2**31, 2**53, 10**400]),
    st.text(alphabet="ax ._µ", max_size=6),
    st.sampled_from(["hex20", "steel", "x", "a.x_min", "a.top", "outer", "a" * 64, "neo_hookean"]),
    st.just({}),
    st.lists(st.one_of(st.integers(-2, 9), st.floats(), st.sampled_from("xyz")), max_size=4),
    st.lists(st.lists(st.integers(-1, 8), min_size=3, max_size=3), max_size=2),
    st.lists(st.lists(st.integers(-1, 8), min_size=8, max_size=8), max_size=2),
)
KEYS = sorted({name for table in [*MANY.values(), *ONCE.values()] for name in table.keys()})


def paths(table, path=()):
    yield path
    entries = table.items() if isinstance(table, dict) else enumerate(table)
    for key, entry in entries if isinstance(table, (dict, list)) else ():
        if isinstance(entry, (dict, list)):
            yield from paths(entry, (*path, key))
        else:
            yield (*path, key)


PATHS = [path for path in paths(FULL) if path]


def mutate(draw, scene):
    path = draw(st.sampled_from(PATHS))
    table = scene
    for step in path[:-1]:
        try:
            table = table[step]
        except (KeyError, IndexError, TypeError):
            return
    if isinstance(table, list) and path[-1] in range(len(table)):
        table[path[-1]] = draw(values)
    elif isinstance(table, dict) and isinstance(path[-1], str):
        how = draw(st.sampled_from(["set", "drop", "other", "unknown"]))
        if how == "drop":
            table.pop(path[-1], None)
        else:
            other = {"set": path[-1], "unknown": path[-1] + "s"}
            table[other.get(how) or draw(st.sampled_from(KEYS))] = draw(values)


@settings(max_examples=400, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_the_schema_accepts_what_the_reader_accepts(data):
    scene = copy.deepcopy(FULL)
    for _ in range(data.draw(st.integers(1, 2))):
        mutate(data.draw, scene)
    assert by_schema(scene) == by_reader(scene), list(Validator(SCHEMA).iter_errors(scene))


@pytest.mark.parametrize(
    "path, value",
    [
        (("material", 0, "poisson"), 0.5),
        (("material", 0, "poisson"), -1),
        (("material", 0, "young"), 0),
        (("material", 0, "young"), "900"),
        (("material", 0, "yuong"), 1.0),
        (("body", 0, "box", "cells"), [2, 2, 0]),
        (("body", 0, "box", "cells"), [2, 2, 2.0]),
        (("body", 1, "ring", "cells"), [1, 2, 1]),
        (("body", 5, "cylinder", "cells"), [1, 10, 1]),
        (("body", 6, "ball", "radius"), [0, 1]),
        (("body", 7, "shell", "cells"), [1, 6]),
        (("body", 0, "mesh"), "two.vtkhdf"),
        (("body", 2, "elements"), [[0, 1, 2]]),
        (("contact", 0, "beta"), 4),
        (("contact", 0, "dissipation"), 1.5),
        (("support", 0, "fix"), ["x", "x"]),
        (("support", 0, "fix"), []),
        (("support", 0, "travel"), [0, 0, 0]),
        (("time", "courant"), 0.5),
        (("damping", "relaxation"), False),
        (("run", "threads"), 1025),
        (("time", "look_every"), 2**53 + 1),
        (("run", "savings"), ["quite"]),
        (("obstacle", 0, "sphere"), {"centre": [0, 0, 0], "radius": 1}),
        (("friction",), [{"coefficient": 0.3}]),
    ],
)
def test_wrong_entries_are_refused_by_both(path, value):
    scene = copy.deepcopy(FULL)
    table = scene
    for step in path[:-1]:
        table = table[step]
    table[path[-1]] = value
    assert not by_schema(scene) and not by_reader(scene)


# Round trips.


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_a_scene_that_is_saved_is_read_as_it_was(data, tmp_path_factory):
    scene = copy.deepcopy(FULL)
    for _ in range(data.draw(st.integers(0, 4))):
        mutate(data.draw, scene)
    try:
        first = ct.Scene(scene)
    except SceneError:
        first = ct.Scene(FULL)
    path = tmp_path_factory.mktemp("saved") / "scene.toml"
    first.save(path)
    second = ct.Scene.load(path)
    assert same(first.data, second.data)
    assert second.toml() == path.read_text(encoding="utf-8")
    parts, again = ([getattr(one._parts, key) for key in Parts.keys()] for one in (first, second))
    assert same(parts, again)


def same(a, b):
    """Equal values of equal types, arrays bit for bit."""
    if isinstance(a, np.ndarray):
        return np.array_equal(a, b) and a.dtype == b.dtype
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
    if isinstance(a, (list, tuple)):
        return len(a) == len(b) and all(map(same, a, b))
    if hasattr(a, "__dataclass_fields__"):
        return type(a) is type(b) and same(vars(a), vars(b))
    return a == b and type(a) is type(b)


# Defaults are those of the C library.


def c_of(name):
    return getattr(lib, f"ct_{name}_default")()


def test_defaults_of_a_contact_are_those_of_c():
    """An empty table gives each member of the C options the library's default."""
    contact = model.Contact.read({"surfaces": ["a.x_max", "b.x_min"]}, Place())
    options = c_of("contact_options")
    members = contact.c("ct_contact_options")
    assert {"method", "enforcement", "dissipation", "points", "adjust"} <= set(members)
    for name, value in members.items():
        assert getattr(options, name) == value, name
    assert options.initial_penetration == model.INITIAL[contact.initial_penetration]
    assert options.removal_time == 0.0 and contact.removal_time is None
    assert options.tolerance > 0 and contact.tolerance is None and contact.depth is None


def test_other_defaults_are_what_zero_means_in_c():
    """Members whose zero means the default in C, and enums whose first word is the default."""
    material = model.Material(name="m", young=1.0, poisson=0.0, density=1.0)
    assert material.c("ct_material")["law"] == ffi.new("ct_material *").law
    time = model.Time(end=1.0, dt=0.1)
    assert model.INTEGRATORS[time.integrator] == ffi.new("ct_integrator *").scheme
    for word, scheme in model.INTEGRATORS.items():
        own = lib.ct_integrator_default(scheme)
        assert model.Time(end=1.0, dt=0.1, integrator=word).parameter == own.parameter
    body = model.Body(name="b", material="m")
    assert model.KERNELS[body.kernel] == lib.CT_KERNEL_AUTO
    obstacle = EFFECTS["obstacle"](surface=("a", "x_max"))
    assert obstacle.dissipation == c_of("contact_options").dissipation
    assert model.ENFORCEMENTS[obstacle.enforcement] == c_of("contact_options").enforcement
    watch = lib.ct_monitor_options_default()
    assert (time.energy_limit, time.look_every) == (watch.energy_limit, watch.every)


def test_the_default_penalty_is_the_one_that_is_built():
    # eq:penalty-default
    data = ct.Scene.load(ct.example("plates")).data
    given = data["contact"][0].pop("beta", None)
    data["contact"][0].pop("enforcement", None)
    facts = ct.Scene(data).explain().data["contacts"][0]
    assert given is not None and facts["penalty_is_default"]
    steel, (plate, *_) = data["material"][0], ct.Scene(data).explain().data["bodies"]
    nu = steel["poisson"]
    modulus = steel["young"] * (1 - nu) / ((1 + nu) * (1 - 2 * nu))
    assert facts["epsilon"] == pytest.approx(40 * modulus / plate["shortest_edge"], rel=1e-12)
    data["contact"][0]["enforcement"] = "penalty"
    explicit = ct.Scene(data).explain().data["contacts"][0]["epsilon"]
    assert explicit == pytest.approx(facts["epsilon"] / 10, rel=1e-12)


@pytest.mark.parametrize("enum", ["law", "scheme", "enforcement", "contact_rule", "initial"])
def test_the_words_are_those_of_the_header(enum):
    known = {
        "law": model.LAWS,
        "scheme": model.INTEGRATORS,
        "enforcement": model.ENFORCEMENTS,
        "contact_rule": model.POINTS,
        "initial": model.INITIAL,
    }[enum]
    constants = ffi.typeof(f"ct_{enum}").elements
    assert len(known) == sum(not name.endswith("_COUNT") for name in constants.values())
    for word, value in known.items():
        assert (
            constants[value].lower().endswith(f"_{word}")
            and getattr(lib, constants[value]) == value
        )


def test_every_law_is_explained_and_named_where_users_choose_it():
    assert set(explain.LAWS) == set(model.LAWS)
    assert set(model.FEEDS) == set(model.ENFORCEMENTS)
    page = Path(__file__).parents[2] / "docs" / "api" / "constraint.rst"
    for words, text in (
        (model.LAWS, model.Material.__doc__),
        (model.ENFORCEMENTS, ct.Contact.__doc__),
        (model.ENFORCEMENTS, page.read_text()),
    ):
        assert [word for word in words if f'"{word}"' not in text] == []


# Derived from the model.


def tables():
    """All tables of the model."""
    stack = [*MANY.values(), *ONCE.values()]
    while stack:
        table = stack.pop()
        yield table
        stack += [
            field.metadata["kind"].model
            for field in table.keys().values()
            if hasattr(field.metadata["kind"], "model")
        ]


@pytest.mark.parametrize("table", dict.fromkeys(tables()), ids=lambda table: table.__name__)
def test_every_key_is_described(table):
    docs = table.docs()
    assert set(docs) == set(table.keys())
    assert all(text.endswith(".") for text in docs.values())


@pytest.mark.parametrize(
    "call, table, more",
    [
        ("add_material", model.Material, set()),
        ("add_body", model.Body, set()),
        ("add_contact", model.Contact, {"a", "b"}),
        ("add_support", model.Support, set()),
        ("set_time", model.Time, set()),
        ("set_output", model.Output, set()),
        ("add_probe", model.Probe, set()),
        ("set_run", model.Run, set()),
    ],
)
def test_calls_take_the_keys_of_the_model(call, table, more):
    method = getattr(ct.Scene, call)
    found = inspect.signature(method).parameters
    assert set(found) == {"self"} | more | set(table.keys())
    for name, field in table.keys().items():
        assert field.default is found[name].default or required(field)
        assert f"\n{name}" in inspect.getdoc(method)
    needed = {name: 1 for name, each in found.items() if each.default is each.empty}
    scene = ct.Scene(units=METRES)
    with pytest.raises(TypeError, match=f"{call}: .*yuong"):
        method(**{**needed, "self": scene}, yuong=1)
    with pytest.raises(
        TypeError, match=f"{call}: too many .*; by name it takes .*{[*table.keys()][-1]}"
    ):
        method(scene, *range(40))
    with pytest.raises(TypeError, match=f'{call}: .*; did you mean "'):
        method(**{**needed, "self": scene}, **{[*found][-1].upper() + "s": 1})


def test_a_scene_is_built_from_the_tables_of_a_file():
    """Each table of a file, with all its keys, is that of a call; only title and units have none."""
    whole = copy.deepcopy(FULL)
    whole["contact"].append({"surfaces": ["a.z_max", "c.outer"], "beta": 3})
    built = ct.Scene(title=whole.pop("title"), units=whole.pop("units"))
    first = ["material", "body", "contact", "support"]  # others name them
    for name in [*first, *(whole.keys() - first)]:
        for table in whole[name] if name in MANY else [whole[name]]:
            if name in EFFECTS:
                built.add(name, **table)
            else:
                getattr(built, f"{'add' if name in MANY else 'set'}_{name}")(**table)
    read_one = ct.Scene({**FULL, "contact": whole["contact"]})
    assert tomllib.loads(built.toml()) == tomllib.loads(read_one.toml())


@pytest.mark.parametrize(
    "wrong", [{}, {"a": "a.x_max"}, {"a": "a.x", "b": "b.x", "surfaces": ["a.x", "b.x"]}]
)
def test_a_contact_has_one_pair_of_surfaces(wrong):
    scene = ct.Scene(units=METRES)
    with pytest.raises(TypeError, match="add_contact: give two surfaces, either a and b or"):
        scene.add_contact(**wrong)


def test_the_book_has_a_table_of_every_key():
    page = (ROOT / "docs" / "theory" / "scene.rst").read_text(encoding="utf-8")
    shown = {line.split()[-1] for line in page.splitlines() if line.startswith(".. scene-keys::")}
    inner = {
        f"{key}.{name}"
        for key, table in {**MANY, **ONCE}.items()
        for name, field in table.keys().items()
        if hasattr(field.metadata["kind"], "model")
    }
    alike = {"gravity.history", "load.history", "obstacle.history"}  # as support.history
    assert shown == {*MANY, *ONCE} | inner - alike


def test_an_effect_of_ones_own_declaration_is_read():
    """A new table needs only its class."""

    class Wind(Effect):
        """
        Wind.

        Attributes
        ----------
        speed
            Its speed.
        """

        speed: float = ct.schema.key(ct.schema.Number(above=0.0), unit="length / time")

    assert Wind.read({"speed": 2}, Place("wind")).speed == 2.0
    with pytest.raises(
        SceneError, match=r'wind.sped: unknown key; did you mean "speed"|speed: is missing'
    ):
        Wind.read({"sped": 2}, Place("wind"))
    assert Wind.schema()["properties"]["speed"]["description"] == "Its speed."
    assert issubclass(Wind, Table)


def test_a_method_that_has_left_is_answered():
    """A table in a file and in a call, and a word: the error says what to write instead."""
    with pytest.raises(
        SceneError, match='averaging: is gone.*write integrator = "tchamwa_wielgosz"'
    ):
        ct.Scene(FULL | {"averaging": {}}).explain()
    with pytest.raises(SceneError, match='averaging: is gone.*"tchamwa_wielgosz"'):
        ct.Scene(FULL).add("averaging")
    with pytest.raises(
        SceneError, match='"pushforward_pullback" is gone.*write "tchamwa_wielgosz"'
    ):
        ct.Scene(FULL | {"time": {"end": 1.0, "integrator": "pushforward_pullback"}}).explain()
    with pytest.raises(ValueError, match='"pushforward_pullback" is gone.*"tchamwa_wielgosz"'):
        ct.dispersion([[1.0, 0.0, 0.0]], integrator="pushforward_pullback")
    with pytest.raises(ValueError, match='mass = "averaged" is gone.*"lumped"'):
        ct.dispersion([[1.0, 0.0, 0.0]], mass="averaged")
