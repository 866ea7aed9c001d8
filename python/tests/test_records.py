"""Structs of the library: made of keywords, frozen, with arrays that share memory and keep it alive."""
import gc
import pickle

import numpy as np
import pytest

import robomill
from robomill import coupling, cutting, modal, monitor, stability, units


def frf(n=5):
    return modal.Frf(name=modal.parse_frf_name(text="xy"), receptance=np.arange(n) * (1 + 2j))


def test_members_are_keywords_and_frozen():
    options = stability.LobesOptions(grid=[3, 4], method="zeroth-order")
    assert list(options.grid) == [3, 4]
    assert options.method == stability.Method.zeroth_order
    with pytest.raises(AttributeError):
        options.grid = [1, 1]
    with pytest.raises(TypeError, match="did you mean grid"):
        stability.LobesOptions(gird=[1, 1])
    with pytest.raises(TypeError, match="LobesOptions.grid cannot be made of a str"):
        stability.LobesOptions(grid="none")


def test_defaults_are_those_of_the_library():
    assert stability.LobesOptions().method == stability.Method.collocation
    assert cutting.FlatEndMill(teeth=3).teeth == 3


def test_enums_take_their_words():
    assert stability.Method("semi-discretization") == stability.Method.semi_discretization
    assert stability.Method("semi_discretization") == stability.Method.semi_discretization
    with pytest.raises(ValueError, match="collocation"):
        stability.Method("none")


def test_arrays_share_memory_and_keep_it_alive():
    one = frf(1000)
    array = one.receptance
    assert not array.flags.owndata and not array.flags.writeable
    assert array.__array_interface__["data"] == one.receptance.__array_interface__["data"]
    kept = modal.FrfSet(frequency_hz=np.arange(1000.0), frfs=[one]).frfs[0].receptance
    del one
    gc.collect()
    assert np.array_equal(kept, np.arange(1000) * (1 + 2j))
    with pytest.raises(ValueError):
        kept[0] = 0


def test_replace_is_a_copy():
    first = stability.LobesOptions(grid=[3, 4])
    second = first.replace(grid=[5, 6])
    assert list(first.grid) == [3, 4] and list(second.grid) == [5, 6]


def test_pickles_come_back():
    one = pickle.loads(pickle.dumps(frf()))
    assert np.array_equal(one.receptance, frf().receptance)
    assert modal.to_string(name=one.name) == "xy"


def test_texts_are_short():
    text = repr(frf(100000))
    assert text.startswith("Frf(") and len(text) < 150 and "array(100000,)" in text


def test_errors_have_their_parts():
    with pytest.raises(robomill.InvalidInput) as caught:
        coupling.Assembly(tool=[coupling.Segment(length_m=-1.0)]).validate()
    assert caught.value.number == -1.0 and caught.value.unit == "m" and "length_m" in caught.value.field
    assert isinstance(caught.value, ValueError)


def test_parameters_are_keywords():
    with pytest.raises(TypeError):
        modal.parse_frf_name("xx")


def test_what_the_library_points_to_is_copied():
    words = monitor.quantity_words()
    assert isinstance(words, list) and len(words) > 20
    assert words[0].quantity.name == "line_share"


def test_units_are_constants():
    assert units.mm == 1e-3 and abs(units.rpm - 2 * np.pi / 60) < 1e-15
