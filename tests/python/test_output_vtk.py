"""The results file in VTK's own reader."""

import numpy as np
import pytest

pytest.importorskip("vtk")
pytest.importorskip("h5py")

from test_output import STEPS, displacement, velocity, write_results  # noqa: E402
from vtkmodules.util.numpy_support import vtk_to_numpy  # noqa: E402
from vtkmodules.vtkCommonCore import reference  # noqa: E402
from vtkmodules.vtkIOHDF import vtkHDFReader  # noqa: E402


@pytest.fixture(scope="module")
def reader(tmp_path_factory):
    made = vtkHDFReader()
    made.SetFileName(str(write_results(tmp_path_factory.mktemp("output"))))
    made.UpdateInformation()
    return made


def grid_of_step(reader, step):
    reader.SetStep(step)
    reader.Update()
    return reader.GetOutputDataObject(0)


def test_counts(reader):
    assert reader.GetNumberOfSteps() == STEPS
    grid = grid_of_step(reader, 0)
    assert grid.GetNumberOfPoints() == 56 and grid.GetNumberOfCells() == 8
    assert [grid.GetCellType(i) for i in range(8)] == [12] * 6 + [25] * 2


@pytest.mark.parametrize("step", [STEPS - 1, 0, 2])
def test_numbers_of_a_step(reader, step):
    grid = grid_of_step(reader, step)
    points = vtk_to_numpy(grid.GetPoints().GetData())
    assert np.allclose(
        vtk_to_numpy(grid.GetPointData().GetArray("displacement")),
        displacement(points, step),
        rtol=0,
        atol=1e-15,
    )
    # The recorded velocity is that of t_n: it differs from the given one by half a step of the forces, which are small
    # here
    half_step = np.abs(
        vtk_to_numpy(grid.GetPointData().GetArray("velocity")) - velocity(step)
    ).max()
    assert half_step < 0.01 * (step + 1)
    stress = vtk_to_numpy(grid.GetCellData().GetArray("stress"))
    assert np.allclose(
        stress, 1e-3 * (step + 1) * np.array([7, 7, 11, 2, -1, 0]), rtol=0, atol=1e-14
    )
    assert vtk_to_numpy(grid.GetCellData().GetArray("body")).tolist() == [0] * 6 + [1] * 2
    field = grid.GetFieldData()
    assert np.allclose(vtk_to_numpy(field.GetArray("momentum")), 7 * velocity(step), rtol=1e-12)
    assert np.isclose(
        field.GetArray("kinetic").GetTuple1(0), 0.5 * 7 * 3.5 * (step + 1) ** 2, rtol=1e-12
    )


def test_times(reader):
    assert np.allclose(
        [reader.GetTimeValue() for step in range(STEPS) if grid_of_step(reader, step)],
        0.2 * np.arange(STEPS),
    )


def test_node_order_of_curved_hex20(reader):
    """VTK's shape functions on our nodes give the map x = a + y² / 10 that bent the box, inside and on each edge."""
    grid = grid_of_step(reader, 0)
    corner_values = [0, 0.25, 0.5, 1]
    for cell, start in ((6, 0.0), (7, 1.0)):
        brick = grid.GetCell(cell)
        number, point, weights = reference(0), [0.0] * 3, [0.0] * 20
        for r in corner_values:
            for s in corner_values:
                for t in corner_values:
                    brick.EvaluateLocation(number, [r, s, t], point, weights)
                    assert np.allclose(point, [start + r + 0.1 * s * s, s, t], rtol=0, atol=1e-14)
    # an edge along y is bent: its middle is not on the chord
    ends, middle = (
        [grid.GetPoint(grid.GetCell(6).GetPointId(i)) for i in (1, 2)],
        grid.GetPoint(grid.GetCell(6).GetPointId(9)),
    )
    assert np.isclose(np.mean(ends, axis=0)[0] - middle[0], 0.025)
