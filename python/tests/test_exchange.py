"""FRFs to and from arrays, pyuff, pyFRF and sdypy-EMA: what went out comes back."""
import numpy as np
import pytest

import robomill
from robomill import exchange, modal

FREQUENCY = np.linspace(0.0, 1000.0, 201)


def receptance(frequency_hz, natural_hz=400.0):
    omega, omega0 = 2 * np.pi * frequency_hz, 2 * np.pi * natural_hz
    return 1 / (omega0**2 - omega**2 + 2j * 0.02 * omega0 * omega)


def test_arrays_come_back():
    frfs = exchange.frfs_from_arrays(FREQUENCY, {"xx": receptance(FREQUENCY)})
    frequency, found = exchange.frfs_to_arrays(frfs)
    assert np.array_equal(frequency, FREQUENCY) and np.array_equal(found["xx"], receptance(FREQUENCY))


def test_accelerance_is_integrated_and_its_line_at_zero_left_out():
    accelerance = -(2 * np.pi * FREQUENCY) ** 2 * receptance(FREQUENCY)
    frequency, found = exchange.frfs_to_arrays(exchange.frfs_from_arrays(FREQUENCY, {"xx": accelerance}, response="acceleration"))
    assert frequency[0] > 0 and np.allclose(found["xx"], receptance(frequency), rtol=1e-12)
    with pytest.raises(robomill.InvalidInput, match="must be one of"):
        exchange.frfs_from_arrays(FREQUENCY, {"xx": accelerance}, response="force")


def test_sets_of_pyuff_come_back_with_signs_and_units():
    used = FREQUENCY[1:]
    frfs = exchange.frfs_from_arrays(used, {"1x:1x": receptance(used), "2y:1x": receptance(used, 300.0)})
    sets = exchange.frfs_to_pyuff(frfs)
    assert sets[1]["rsp_node"] == 2 and sets[1]["rsp_dir"] == 2 and sets[1]["ordinate_spec_data_type"] == 8
    back = exchange.frfs_from_pyuff(sets)
    assert [modal.to_string(name=one.name) for one in back.frfs] == [modal.to_string(name=one.name) for one in frfs.frfs]
    turned = exchange.frfs_from_pyuff([{**sets[0], "rsp_dir": -1, "ordinate_spec_data_type": 12, "data": -(2 * np.pi * used) ** 2 * sets[0]["data"]}])
    assert np.allclose(turned.frfs[0].receptance, -receptance(used), rtol=1e-12)
    with pytest.raises(robomill.InvalidInput, match="give response="):
        exchange.frfs_from_pyuff([{**sets[0], "ordinate_spec_data_type": 0}])
    with pytest.raises(robomill.InvalidInput, match="no FRF"):
        exchange.frfs_from_pyuff([{"type": 151}])


def test_arrays_and_poles_for_ema():
    used = FREQUENCY[1:]
    frfs = exchange.frfs_from_arrays(used, {"1x:1x": receptance(used), "2x:1x": receptance(used), "1x:2x": receptance(used)})
    matrix, frequency, names = exchange.frfs_to_ema(frfs, excitation="1x")
    assert matrix.shape == (2, len(used)) and np.array_equal(frequency, used) and len(names) == 2
    model = modal.modes_from_mass(x=[modal.MassMode(frequency_hz=400.0, damping_ratio=0.02, modal_mass_kg=1.0)], y=[])
    poles = exchange.poles_to_ema(model)
    assert np.isclose(np.abs(poles["poles"][0]), 2 * np.pi * 400.0) and np.isclose(-poles["poles"][0].real / np.abs(poles["poles"][0]), 0.02)
