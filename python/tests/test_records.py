"""Structs of the library: made of keywords, frozen, with arrays that share memory and keep it alive."""
import gc
import inspect
import pathlib
import pickle
import re
import types

import numpy as np
import pytest

import robomill
from robomill import cell, coupling, cutting, jobs, modal, monitor, process, stability, units


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


def arm():
    root = pathlib.Path(__file__).resolve().parents[2]
    found = cell.read_cell(source=root / "examples/smooth-impeller-like/cell.toml")
    return cell.kinematics(cell=found)


def test_inverse_kinematics_come_back():
    machine = arm()
    limits = machine.limits()
    position = 0.5 * (limits.min_position + limits.max_position) + 0.3
    pose = machine.forward(position=position)
    reach, found = machine.follow(pose=pose, near=position + 0.01)
    assert reach.status.name == "found" and np.allclose(found, position, atol=1e-9)
    branches = machine.all(pose=pose, room=64)
    assert len(branches) > 1 and any(np.allclose(one, position, atol=1e-9) for one in branches)
    for one in branches:
        assert np.allclose(machine.forward(position=one).tip_m, pose.tip_m, atol=1e-9)
    assert len(machine.all(pose=pose, room=1)) == 1


def test_errors_are_values_too():
    error = monitor.chatter_in(recording="air.wav", alarm_s=2.5)
    assert isinstance(error, robomill.InvalidInput) and "air.wav" in str(error) and error.rule
    outer = robomill.within(prefix="tool[1].", error=robomill.InvalidInput("must be > 0"))
    assert outer.rule == "must be > 0" and robomill.InvalidInput("x").unit == ""
    with pytest.raises(TypeError):
        robomill.within(prefix="tool[1].", error=ValueError("x"))


def test_what_a_struct_refers_to_lives_as_long():
    judged = process.JudgedProgram(forces=process.ForcesResult(), blocks=process.ProgramBlocks(), judging=process.BlocksJudging(), map_blocks=[1, 2])
    gc.collect()
    assert isinstance(judged.forces, process.ForcesResult) and list(judged.map_blocks) == [1, 2]
    with pytest.raises(TypeError):
        process.JudgedProgram(forces=process.ForcesResult())


def test_documents_to_begin_with_are_found():
    files = jobs.init_files(options=jobs.InitOptions(kind="job", file="/tmp", example=True))
    assert files.document(kind="lobes").kind.name == "job" and files.document(kind="cell") is None


def documented():
    for name, module in vars(robomill).items():
        if isinstance(module, types.ModuleType) and module.__name__.startswith("robomill._robomill"):
            for scope in [module, *(one for one in vars(module).values() if isinstance(one, type))]:
                yield from ((f"{name}.{key}", getattr(scope, key)) for key in vars(scope) if not key.startswith("_") and callable(getattr(scope, key)))


def test_docstrings_of_overloads_begin_with_how_each_is_called():
    text = modal.write_frfs.__doc__
    assert text.index("write_frfs(*, path, set, options=...)\n\n") < text.index("\n\nwrite_frfs(*, path, result, options=...)\n\n")


def test_signatures_and_docstrings_have_the_same_parameters():
    checked = 0
    for name, thing in documented():
        try:
            signature = inspect.signature(thing)
        except (ValueError, TypeError):
            continue  # of several signatures, or of an enum
        given = [one for one in signature.parameters if one != "self"]
        parts = (thing.__doc__ or "").split("Parameters\n----------\n")
        listed = re.findall(r"^(\w+) : ", parts[1].split("\n\n")[0], re.M) if len(parts) > 1 else []
        assert listed == given or "Attributes\n----------\n" in thing.__doc__, name
        checked += 1
    assert checked > 900


def test_docstrings_have_sections_for_results_and_errors():
    text = stability.compute_lobes.__doc__
    assert "Returns\n-------\nLobesResult" in text and "Raises\n------\nInvalidInput\n    if the problem" in text and "@" not in text
    assert str(inspect.signature(stability.compute_lobes)) == "(*, problem, options, progress=None)"
    assert "spindle_speed_rad_per_s : array_like" in stability.LobesOptions.__doc__
    assert list(inspect.signature(stability.LobesOptions).parameters)[:2] == ["spindle_speed_rad_per_s", "axial_depth_m"]
