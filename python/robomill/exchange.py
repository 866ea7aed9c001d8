"""FRFs from and to arrays and other packages: pyuff's data sets, pyFRF's objects, the arrays that sdypy-EMA takes, and its poles.

FRFs are receptances in m/N here, as `robomill.modal.FrfSet` has them; what is measured as velocity or acceleration is divided by iω or (iω)²."""
import numpy as np

from . import _robomill

_modal = _robomill.modal
_AXES = {1: "x", 2: "y", 3: "z"}
_KINDS = {8: "displacement", 11: "velocity", 12: "acceleration"}
_ORDERS = {"displacement": 0, "velocity": 1, "acceleration": 2}


def _receptance(values, frequency_hz, response):
    if response not in _ORDERS:
        raise _robomill.InvalidInput(f"response = {response}; must be one of {', '.join(_ORDERS)}")
    order = _ORDERS[response]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(values, dtype=complex) / (2j * np.pi * frequency_hz) ** order if order else np.asarray(values, dtype=complex)


def frfs_from_arrays(frequency_hz, receptances, *, response="displacement"):
    """An FrfSet of arrays.

    Parameters
    ----------
    frequency_hz : array of n
        increasing; a line at 0 Hz is left out where the response is no displacement
    receptances : mapping of str to array of n
        by FRF: "xx", "xy", "1x:3y"
    response : str
        what was measured: displacement, velocity or acceleration, in SI units

    Returns
    -------
    robomill.modal.FrfSet

    Raises
    ------
    InvalidInput
        if lengths differ, a number is not finite, or frequencies do not increase
    """
    frequency = np.asarray(frequency_hz, dtype=float)
    used = frequency > 0 if _ORDERS.get(response) else np.ones(len(frequency), dtype=bool)
    made = [_modal.Frf(name=_modal.parse_frf_name(text=name), receptance=_receptance(np.asarray(values)[used], frequency[used], response))
            for name, values in receptances.items()]
    out = _modal.FrfSet(frequency_hz=frequency[used], frfs=made)
    out.validate()
    return out


def frfs_to_arrays(frfs):
    """Arrays of an FrfSet.

    Parameters
    ----------
    frfs : robomill.modal.FrfSet

    Returns
    -------
    tuple(array of n, dict of str to array of n)
        frequencies in Hz, and receptances in m/N by name
    """
    return np.array(frfs.frequency_hz), {_modal.to_string(name=one.name): np.array(one.receptance) for one in frfs.frfs}


def frfs_from_pyuff(sets, *, response=None):
    """An FrfSet of pyuff's data sets: those of type 58 that are FRFs (function type 4); others are left out.

    Parameters
    ----------
    sets : sequence of dict
        as pyuff.UFF.read_sets() returns them
    response : str, optional
        where a set does not say what its ordinate is: displacement, velocity or acceleration

    Returns
    -------
    robomill.modal.FrfSet

    Raises
    ------
    InvalidInput
        if none is an FRF, one does not say what it is, has another direction than x, y, z, or other frequencies than the rest
    """
    found, frequency = {}, None
    for one in [sets] if isinstance(sets, dict) else sets:
        if one.get("type") != 58 or one.get("func_type") != 4:
            continue
        axes = [_AXES.get(abs(int(one[key]))) for key in ("rsp_dir", "ref_dir")]
        if None in axes:
            raise _robomill.InvalidInput(f"rsp_dir, ref_dir = {one['rsp_dir']}, {one['ref_dir']}; must be ±1, ±2 or ±3: x, y or z")
        kind = _KINDS.get(one.get("ordinate_spec_data_type")) or response
        if kind is None:
            raise _robomill.InvalidInput("ordinate_spec_data_type: says neither displacement nor velocity nor acceleration; give response=")
        name = f"{int(one['rsp_node'])}{axes[0]}:{int(one['ref_node'])}{axes[1]}"
        lines = np.asarray(one["x"], dtype=float)
        used = lines > 0
        if frequency is not None and not np.array_equal(frequency, lines[used]):
            raise _robomill.InvalidInput(f"x of {name}: the FRFs have different frequencies")
        frequency = lines[used]
        sign = np.sign(one["rsp_dir"]) * np.sign(one["ref_dir"])
        found[name] = sign * _receptance(np.asarray(one["data"])[used], frequency, kind)
    if not found:
        raise _robomill.InvalidInput("sets: no FRF (type 58, func_type 4) among them")
    return frfs_from_arrays(frequency, found)


def frfs_to_pyuff(frfs):
    """Data sets of type 58, as pyuff writes them.

    Parameters
    ----------
    frfs : robomill.modal.FrfSet

    Returns
    -------
    list of dict

    Raises
    ------
    InvalidInput
        if one has a rotation or a moment, which pyuff's sets have not
    """
    codes = {axis: code for code, axis in _AXES.items()}
    sets = []
    for one in frfs.frfs:
        dofs = one.name.response, one.name.excitation
        axes = [dof.axis.name for dof in dofs]
        if any(axis not in codes for axis in axes):
            raise _robomill.InvalidInput(f"{_modal.to_string(name=one.name)}: a data set 58 of pyuff has directions x, y, z alone")
        sets.append({"type": 58, "binary": 0, "func_type": 4, "rsp_node": dofs[0].point, "rsp_dir": codes[axes[0]], "ref_node": dofs[1].point,
                     "ref_dir": codes[axes[1]], "rsp_ent_name": "NONE", "ref_ent_name": "NONE", "ver_num": 1, "load_case_id": 0, "abscissa_spacing": 0,
                     "abscissa_min": float(frfs.frequency_hz[0]), "abscissa_inc": 0.0, "abscissa_spec_data_type": 18, "ordinate_spec_data_type": 8,
                     "orddenom_spec_data_type": 13, "ord_data_type": 6, "num_pts": len(frfs.frequency_hz), "z_axis_value": 0.0,
                     "id1": _modal.to_string(name=one.name), "x": np.array(frfs.frequency_hz), "data": np.array(one.receptance)})
    return sets


def frfs_from_pyfrf(measured, name="xx"):
    """An FrfSet of a pyFRF.FRF that has its data.

    Parameters
    ----------
    measured : pyFRF.FRF
        of one response and one excitation
    name : str
        which FRF it is

    Returns
    -------
    robomill.modal.FrfSet
    """
    values = np.squeeze(measured.get_FRF(form="receptance"))
    frequency = np.asarray(measured.get_f_axis(), dtype=float)
    used = frequency > 0
    return frfs_from_arrays(frequency[used], {name: values[..., used]})


def frfs_to_ema(frfs, excitation=None):
    """FRFs of one excitation as sdypy.EMA.Model(frf, freq, frf_type="receptance") takes them.

    Parameters
    ----------
    frfs : robomill.modal.FrfSet
    excitation : str, optional
        "1x"; that of the first FRF by default

    Returns
    -------
    tuple(array of m x n, array of n, list of str)
        receptances in m/N, a row a response; frequencies in Hz; the names of the rows
    """
    reference = frfs.frfs[0].name.excitation if excitation is None else _modal.parse_dof(text=excitation)
    text = _modal.to_string(dof=reference)
    rows = [one for one in frfs.frfs if _modal.to_string(dof=one.name.excitation) == text]
    return np.array([one.receptance for one in rows]), np.array(frfs.frequency_hz), [_modal.to_string(name=one.name) for one in rows]


def poles_to_ema(model):
    """Natural frequencies, damping ratios and poles of a model, as sdypy-EMA names them.

    Parameters
    ----------
    model : robomill.modal.ModalModel

    Returns
    -------
    dict of str to array
        nat_freq in Hz, nat_xi, poles in rad/s
    """
    frequency = np.array([mode.frequency_hz for mode in model.modes])
    damping = np.array([mode.damping_ratio for mode in model.modes])
    omega = 2 * np.pi * frequency
    return {"nat_freq": frequency, "nat_xi": damping, "poles": omega * (-damping + 1j * np.sqrt(1 - damping**2))}
