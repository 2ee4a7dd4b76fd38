"""The Python interface of the exact solutions: arrays, refusals, fronts, the series."""

import math

import numpy as np
import pytest

import libcontact as ct


def series(*args, **kwargs):
    try:
        return ct.exact.plates_series(*args, **kwargs)
    except ct.NotBuiltIn as reason:
        pytest.skip(str(reason))


def flat(fields):
    (sigma_x, sigma_z, tau_xz), (v_x, v_z) = fields
    return np.array([sigma_x, sigma_z, tau_xz, v_x, v_z])


def test_uniaxial_strain_ahead_of_the_faces():
    x = np.linspace(0, 1, 201)
    (sigma_x, sigma_z, tau), (v_x, v_z) = ct.exact.plates(x, 0.0, 0.56, nu=0.3)
    behind = x <= 0.56
    assert np.allclose(sigma_x, np.where(behind, -7 / 3, 0.0), rtol=0, atol=3e-15)
    assert np.array_equal(sigma_z, np.where(behind, -1.0, 0.0))
    assert np.array_equal(v_x, np.where(behind, 0.0, -1.0))
    assert not tau.any() and not v_z.any()


def test_arrays_broadcast_and_convert():
    x = np.linspace(0, 0.5, 4)[:, None]
    z = np.linspace(-0.9, 0.9, 6)[None, ::2]
    fields = ct.exact.plates(x, z, 0.5)
    assert all(a.shape == (4, 3) for a in (*fields.stress, *fields.velocity))
    for i in range(4):
        for j in range(3):
            assert np.array_equal(
                flat(fields)[:, i, j], flat(ct.exact.plates(x[i, 0], z[0, j], 0.5))
            )
    single = np.float32(0.25)
    assert np.array_equal(
        flat(ct.exact.plates(single, 0, 0.5)), flat(ct.exact.plates(0.25, 0.0, 0.5))
    )
    assert (
        np.ndim(fields.stress.sigma_x) == 2
        and np.ndim(ct.exact.plates(0.1, 0.1, 0.1).velocity.v_x) == 0
    )
    assert ct.exact.plates([], [], 0.5).stress.tau_xz.shape == (0,)


@pytest.mark.parametrize(
    "wrong, word",
    [
        ((-0.1, 0, 0.5), "x < 0"),
        ((0.1, 1.1, 0.5), r"\|z\|"),
        ((0.1, 0, -1e-9), "t < 0"),
        ((0.1, 0, 2), "t >= 2"),
        ((np.nan, 0, 1), "number"),
        ((0.1, 0, np.nan), "number"),
        ((1.8, 0, 0.5), "2 length"),
    ],
)
def test_points_outside_validity_are_refused_with_their_index(wrong, word):
    x, z, t = np.array([(0.1, 0.0, 0.5)] * 3 + [wrong] + [(-1, -9, -9)]).T
    with pytest.raises(ValueError, match=f"point 3 .*{word}"):
        ct.exact.plates(x, z, t, length=1.1)
    with pytest.raises(ValueError, match=r"\[index \(1, 1\)\]"):
        ct.exact.plates(x[:4].reshape(2, 2), z[:4].reshape(2, 2), t[:4].reshape(2, 2), length=1.1)


@pytest.mark.parametrize("nu", [0.0, -0.3, 0.4901, 0.5, math.nan])
def test_poisson_ratio_out_of_range_is_refused(nu):
    with pytest.raises(ValueError, match="nu"):
        ct.exact.plates(0.1, 0.1, 0.1, nu=nu)
    with pytest.raises(ValueError, match="nu"):
        ct.exact.speeds(nu)


def test_series_tends_to_the_closed_form_on_the_line_of_figure_5():
    z = (np.arange(100) + 0.5) / 100
    exact = ct.exact.plates(0.4, z, 0.56).stress.sigma_z
    for branches, expected in ((10, 0.095), (50, 0.020)):
        partial = series(0.4, z, 0.56, branches=branches).stress.sigma_z
        assert np.abs(partial - exact).mean() == pytest.approx(expected, rel=0.1)


def test_series_refuses_what_it_does_not_know():
    series(0.1, 0.1, 0.1, branches=1)
    for branches in (0, -5, 20000):
        with pytest.raises(ValueError, match="branches"):
            ct.exact.plates_series(0.1, 0.1, 0.1, branches=branches)
    with pytest.raises(ValueError, match="point 1 "):
        ct.exact.plates_series([0.1, 0.1], [0.0, 2.0], 0.1, branches=1)


def test_fronts_are_where_the_fields_change():
    """eq:plates-head. Just outside the outermost fronts all fields are zero; curves touch where theory predicts it."""
    t, nu = 0.56, 0.3
    curves = ct.exact.fronts(t, nu)
    for side, z_face in ((0, 1.0), (1, -1.0)):
        x, z = curves["circular_p"][side].T
        assert np.allclose(np.hypot(x, z - z_face), t)
        outside = np.hypot(x, z - z_face) > 0
        assert outside.all()
        inner = x[1:-1] * 1.0001, z_face + (z[1:-1] - z_face) * 1.0001
        assert np.allclose(flat(ct.exact.plates(*inner, t, nu))[1][inner[0] <= t], -1.0, atol=1e-12)
        (start, touch) = curves["head"][side]
        assert np.allclose(start, [t, z_face])
        slope = math.degrees(math.atan2(abs(touch[1] - z_face), t - touch[0]))
        assert slope == pytest.approx(32.3, abs=0.05)
        c2 = ct.exact.speeds(nu).c2
        assert math.hypot(touch[0], touch[1] - z_face) == pytest.approx(c2 * t)
        assert np.dot(touch - start, touch - [0.0, z_face]) == pytest.approx(0.0, abs=1e-15)
    # facts of the line x = 0.4: circular P at 0.6081, head wave at 0.8988
    (x0, z0), (x1, z1) = curves["head"][0]
    assert z0 + (z1 - z0) * (0.4 - x0) / (x1 - x0) == pytest.approx(0.8988, abs=5e-5)
    assert 1 - math.sqrt(t * t - 0.16) == pytest.approx(0.6081, abs=5e-5)
    with pytest.raises(ValueError):
        ct.exact.fronts(2.0)
