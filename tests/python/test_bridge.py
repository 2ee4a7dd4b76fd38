"""Data that Python takes from the C headers: the compiler's layout of structs, and the constants of enums."""

import numpy as np
import pytest
from libcontact._core import ffi

import libcontact as ct
from libcontact import bridge, mesh

STRUCTS = ["ct_projection", "ct_ray_hit", "ct_nearest", "ct_energy", "ct_momentum"]


@pytest.mark.parametrize("struct", [*STRUCTS, "ct_contact_point"])
def test_rows_lie_in_memory_as_the_compiler_lays_them(struct):
    row = bridge.row(struct)
    assert row.itemsize == ffi.sizeof(struct)
    for name, (dtype, offset) in row.fields.items():
        assert offset == ffi.offsetof(struct, name)
        # C reads the number that Python writes.
        rows = np.zeros(1, row)
        rows[name] = np.arange(1, dtype.shape[0] + 1) if dtype.shape else 1
        read = getattr(ffi.from_buffer(f"{struct}[]", rows)[0], name)
        assert (list(read) if dtype.shape else read) == rows[name][0].tolist()


def test_statuses_have_the_names_of_the_library():
    """They are the first values of ct_status: those without an error and that of invalid input."""
    constants = sorted(ffi.typeof("ct_status").elements.items())[: len(ct.Status)]
    assert [(status.value, f"CT_{status.name}") for status in ct.Status] == constants
    assert [status.value for status in ct.Status] == [0, 1, 2, 3, 4]


def test_each_kind_of_element_has_a_row_and_the_name_of_its_constant():
    assert list(mesh.FACTS) == list(mesh.KINDS) == ["hex8", "hex20"]
    for name, facts in mesh.FACTS.items():
        assert facts != ffi.NULL and ffi.string(facts.name).decode() == name
    types = {facts.vtk for facts in mesh.FACTS.values()}
    assert len(types) == len(set(mesh.WIDTH.values())) == len(mesh.KINDS)


def test_impossible_arrays_are_refused():
    assert bridge.real("x", [], ("m",)).shape == (0,)
    assert bridge.real("x", np.float32(0.5)).shape == ()
    for values in ("a", [1j], [True], np.ones(1, np.longdouble)):
        with pytest.raises(TypeError, match="x must be real numbers"):
            bridge.real("x", values)
    with pytest.raises(ValueError, match="x has masked values"):
        bridge.real("x", np.ma.masked_less([1.0, 2.0], 1.5))
    with pytest.raises(ValueError, match=r"x must have shape \(2,\) or \(m, 3\), not \(3,\)"):
        bridge.real("x", [1, 2, 3], (2,), ("m", 3))
    with pytest.raises(TypeError, match="float32 can't be passed to C"):
        bridge.doubles(np.ones(3, np.float32))
    with pytest.raises(ValueError, match="fit 32 bits"):
        bridge.whole("x", [2**31])
