#!/usr/bin/env python3
"""Draws the ROC curves of calibrations as an SVG, from the JSON that `robomill calibrate --report x.json` writes:
bench/monitor_roc.py normalised.json energy.json > robomill/monitor/roc.svg"""
import json
import sys

from figure import COLOURS, Axis, Figure


def main():
    calibrations = []
    for name in sys.argv[1:]:
        with open(name, encoding="utf-8") as file:
            calibrations.append(json.load(file))
    percent = [(p / 100, f"{p}") for p in range(0, 101, 20)]
    figure = Figure(Axis(-0.02, 1.02, "stable recordings with a false alarm (%)", ticks=percent),
                    Axis(-0.02, 1.02, "recordings with chatter found (%)", ticks=percent), right=260)
    for colour, calibration in zip(COLOURS, calibrations):
        below = "below" if calibration["alarm"] == "below" else "above"
        figure.legend(f'{calibration["entropy"]}, chatter {below} {calibration["threshold"]:.3g}:')
        for half, dashed in (("setting", True), ("verifying", False)):
            of = calibration[half]
            figure.curve([(p["false_alarm_rate"], p["detection_rate"]) for p in of["roc"]], colour, dashed)
            figure.legend(f'{half} half, {of["stable"]} + {of["chatter"]}', colour, dashed)
        for half, hollow in (("setting", True), ("verifying", False)):
            chosen = calibration[half]["chosen"]
            rate, found = chosen["false_alarm_rate"], chosen["detection_rate"]
            figure.mark(rate, found, colour, hollow)
            figure.legend(f"set: {100 * rate:.1f} %, {100 * found:.1f} %" if hollow else
                          f"verified: {100 * rate:.1f} %, {100 * found:.1f} %", colour, hollow=hollow)
        figure.gap()
    figure.legend("n + n: stable + with chatter.")
    figure.legend("An alarm before the onset")
    figure.legend("finds nothing: curves fall.")
    figure.print()


main()
