"""Figures of results, with matplotlib. Each function takes a verb's result or its document, draws into `axes` (or new ones) and
returns them."""
import numpy as np

__all__ = ["forces", "frfs", "gamma_map", "lobes", "modes", "spectrogram", "trajectory"]


def _document(result):
    return result if isinstance(result, dict) else result.to_dict()


def _axes(axes, rows=1, height=3.2):
    if axes is not None:
        return axes
    import matplotlib.pyplot as plt

    _, made = plt.subplots(rows, 1, figsize=(7, height * rows), layout="constrained", sharex=rows > 1)
    return made


def _numbers(values):
    return np.array([np.nan if value is None else value for value in values], dtype=float)


def lobes(result, *, axes=None):
    """The stability limit over the spindle speed in rpm, with its 5 to 95 % band where an uncertainty was asked for.

    Parameters
    ----------
    result : Result or dict
        of robomill.lobes, or lobes.json
    axes : matplotlib.axes.Axes, optional
        to draw into; new ones by default

    Returns
    -------
    matplotlib.axes.Axes
    """
    document = _document(result)
    axes = _axes(axes)
    for curve in sorted({point["curve"] for point in document.get("boundary", [])}):
        points = [point for point in document["boundary"] if point["curve"] == curve]
        style = {"marker": ".", "linestyle": "none"} if curve == 0 else {}
        axes.plot([p["spindle_speed_rpm"] for p in points], [p["axial_depth_mm"] for p in points], color="C0", **style)
    if not document.get("boundary") and document.get("limit"):
        axes.plot([p["spindle_speed_rpm"] for p in document["limit"]], _numbers(p["axial_depth_mm"] for p in document["limit"]), color="C0")
    band = document.get("uncertainty")
    if band:
        axes.fill_between(band["spindle_speed_rpm"], _numbers(band["limit_5_percent_mm"]), _numbers(band["limit_95_percent_mm"]), alpha=0.2, color="C0",
                          label="5 to 95 %")
        axes.legend()
    for point in document.get("points", []):
        axes.plot(point["spindle_speed_rpm"], point["axial_depth_mm"], "o" if point["stable"] else "x", color="C2" if point["stable"] else "C3")
    axes.set(xlabel="spindle speed in rpm", ylabel="axial depth in mm")
    return axes


def _receptance(model, name, frequency_hz):
    """Of the modes of modes.json: Σ r lᵀ/(iω - λ) + its conjugate, the residuals left out."""
    response, force = name.split(":") if ":" in name else (name[0], name[1])
    s = 2j * np.pi * np.asarray(frequency_hz)
    out = np.zeros(len(s), dtype=complex)
    for mode in model["modes"]:
        if response not in mode["right"] or force not in mode["left"]:
            continue
        omega = 2 * np.pi * mode["frequency_hz"]
        pole = omega * (-mode["damping_ratio"] + 1j * np.sqrt(1 - mode["damping_ratio"] ** 2))
        residue = complex(*mode["right"][response]) * complex(*mode["left"][force])
        out += residue / (s - pole) + np.conj(residue) / (s - np.conj(pole))
    return out


def frfs(result, *, fit=None, names=None, axes=None):
    """Magnitude of receptances in µm/N over the frequency in Hz.

    Parameters
    ----------
    result : Result or dict
        of robomill.frf or robomill.couple, or tip.json
    fit : Result or dict, optional
        of robomill.modes, or modes.json: its receptances dashed beside them, residuals left out
    names : sequence of str, optional
        which FRFs, "xx"; all by default
    axes : matplotlib.axes.Axes, optional
        to draw into; new ones by default

    Returns
    -------
    matplotlib.axes.Axes
    """
    document = _document(result)
    axes = _axes(axes)
    frequency = np.array(document["frequency_hz"])
    model = None if fit is None else _document(fit)
    for i, name in enumerate(names or document["receptance_m_per_n"]):
        values = document["receptance_m_per_n"][name]
        axes.semilogy(frequency, 1e6 * np.hypot(_numbers(values["re"]), _numbers(values["im"])), color=f"C{i}", label=name)
        if model is not None:
            axes.semilogy(frequency, 1e6 * np.abs(_receptance(model, name, frequency)), "--", color=f"C{i}")
    axes.set(xlabel="frequency in Hz", ylabel="receptance in µm/N")
    axes.legend()
    return axes


def modes(result, *, axes=None):
    """Damping ratios in % over frequencies in Hz, with two standard deviations where the fit has them.

    Parameters
    ----------
    result : Result or dict
        of robomill.modes, or modes.json
    axes : matplotlib.axes.Axes, optional
        to draw into; new ones by default

    Returns
    -------
    matplotlib.axes.Axes
    """
    document = _document(result)
    axes = _axes(axes)
    for number, mode in enumerate(document["modes"], 1):
        deviations = mode.get("std") or {}
        axes.errorbar(mode["frequency_hz"], 100 * mode["damping_ratio"], fmt="o", color="0.6" if mode.get("weak") else "C0",
                      xerr=2 * (deviations.get("frequency_hz") or 0.0), yerr=200 * (deviations.get("damping_ratio") or 0.0))
        axes.annotate(str(number), (mode["frequency_hz"], 100 * mode["damping_ratio"]), xytext=(5, 5), textcoords="offset points")
    axes.set(xlabel="frequency in Hz", ylabel="damping ratio in %")
    return axes


def forces(result, *, axes=None):
    """Forces in N over a revolution, with the record beside them where there is one; of a program the peak force of each block.

    Parameters
    ----------
    result : Result or dict
        of robomill.forces, or forces.json
    axes : matplotlib.axes.Axes, optional
        to draw into; new ones by default

    Returns
    -------
    matplotlib.axes.Axes
    """
    document = _document(result)
    axes = _axes(axes)
    if document.get("blocks"):
        axes.step([block["time_s"] for block in document["blocks"]], _numbers(block["peak_f_n"] for block in document["blocks"]), where="post")
        axes.set(xlabel="time in s", ylabel="peak force in N")
        return axes
    for i, name in enumerate(("fx_n", "fy_n", "fz_n")):
        axes.plot(document["rotation_deg"], document[name], color=f"C{i}", label=name[:2])
        if document.get("measured"):
            measured = document["measured"]
            axes.plot(document["rotation_deg"], measured[name], ":", color=f"C{i}", label=f"{name[:2]} measured")
    axes.set(xlabel="rotation in °", ylabel="force in N")
    axes.legend()
    return axes


def trajectory(table, *, limits=None, period_s=None, joints=None, axes=None):
    """Positions, velocities, accelerations and jerks of joints, as shares of their limits where these are given.

    Parameters
    ----------
    table : mapping of str to array
        columns of a trajectory: time_s, q1, q2, … in rad or m
    limits : mapping of str to array, optional
        velocity, acceleration and jerk of each joint
    period_s : float, optional
        sample period in s; by default that of time_s
    joints : sequence of str, optional
        which columns; by default all that are joints
    axes : sequence of four matplotlib.axes.Axes, optional
        position, velocity, acceleration, jerk; new ones by default

    Returns
    -------
    sequence of matplotlib.axes.Axes
    """
    time = np.asarray(table["time_s"], dtype=float)
    step = float(np.median(np.diff(time))) if period_s is None else period_s
    names = joints or [name for name in table if name.startswith("q") and name[1:].isdigit()]
    axes = _axes(axes, rows=4, height=1.9)
    for number, name in enumerate(names):
        values = np.asarray(table[name], dtype=float)
        axes[0].plot(time, values, label=name)
        for row, kind in enumerate(("velocity", "acceleration", "jerk"), 1):
            values = np.gradient(values, step)
            axes[row].plot(time, values / limits[kind][number] if limits else values)
    for row, label in enumerate(("position", "velocity", "acceleration", "jerk")):
        axes[row].set_ylabel(label if row == 0 or not limits else f"{label} / limit")
        if row > 0 and limits:
            axes[row].axhline(1, color="0.6", linewidth=0.8)
            axes[row].axhline(-1, color="0.6", linewidth=0.8)
    axes[0].legend(ncols=6)
    axes[-1].set_xlabel("time in s")
    return axes


def spectrogram(samples, sample_rate_hz, *, decisions=(), window_s=0.1, axes=None):
    """Level of a signal over time and frequency, and above it the states that a monitor decided.

    Parameters
    ----------
    samples : array of n
        of one channel
    sample_rate_hz : float
        in Hz
    decisions : sequence of (time_s, state), optional
        as the monitor gave them, by time
    window_s : float, optional
        length of the windows in s
    axes : matplotlib.axes.Axes, optional
        to draw into; new ones by default

    Returns
    -------
    matplotlib.axes.Axes
    """
    samples = np.asarray(samples, dtype=float)
    axes = _axes(axes)
    length = max(16, int(window_s * sample_rate_hz))
    axes.specgram(samples, NFFT=length, Fs=sample_rate_hz, noverlap=3 * length // 4, cmap="magma")
    colours = {"stable": "C2", "transition": "C1", "chatter": "C3", "blind": "0.6"}
    times = [time for time, _ in decisions] + [len(samples) / sample_rate_hz]
    for (begin, state), end in zip(decisions, times[1:]):
        axes.axvspan(begin, end, ymin=0.97, color=colours[str(getattr(state, "name", state))])
    axes.set(xlabel="time in s", ylabel="frequency in Hz")
    return axes


def gamma_map(result, *, axes=None):
    """How the limit of the worst block, in mm, depends on the turn about the tool's axis and on positions.

    Parameters
    ----------
    result : Result or dict
        of robomill.plan of a program, or blocks.json
    axes : matplotlib.axes.Axes, optional
        to draw into; new ones by default

    Returns
    -------
    matplotlib.axes.Axes
    """
    document = _document(result)
    document = document.get("blocks") if "limit_over" not in document and isinstance(document.get("blocks"), dict) else document
    axes = _axes(axes)
    for scan in document["limit_over"]:
        axes.plot(scan["value"], _numbers(scan["limit_depth_mm"]), label=scan["parameter"])
    axes.set(xlabel="coordinate, in the unit of its name", ylabel="limit in mm")
    axes.legend()
    return axes
