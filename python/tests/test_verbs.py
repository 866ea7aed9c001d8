"""Verbs as functions give what the command line gives, bit by bit."""
import json
import os
import pathlib
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

import robomill

PROGRAM = os.environ["ROBOMILL"]
EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"
LOBES = EXAMPLES / "ball-end-lobes/lobes.toml"


def command_line(*words):
    done = subprocess.run([PROGRAM, *map(str, words), "-o", "-", "--quiet"], capture_output=True, text=True)
    assert done.returncode in (0, 3), done.stderr
    return json.loads(done.stdout)


def without_times(value):
    """Computing times differ from run to run."""
    if isinstance(value, dict):
        return {key: without_times(one) for key, one in value.items() if key not in ("seconds", "plan_seconds", "microseconds_per_sample", "created")}
    if isinstance(value, list):
        return [without_times(one) for one in value]
    return value


@pytest.mark.parametrize("words, call", [
    (["lobes", LOBES, "--at", "12000,0.5"], lambda file: robomill.lobes(LOBES, at=[(12000, 0.5)])),
    (["couple", EXAMPLES / "new-tool/assembly.toml"], lambda file: robomill.couple(EXAMPLES / "new-tool/assembly.toml")),
    (["plan", EXAMPLES / "new-tool/job.toml"], lambda file: robomill.plan(EXAMPLES / "new-tool/job.toml")),
    (["forces", EXAMPLES / "ball-end-ur5e/cut-1.toml"], lambda file: robomill.forces(EXAMPLES / "ball-end-ur5e/cut-1.toml")),
    (["forces", EXAMPLES / "force-along-program/forces.toml", "--program", EXAMPLES / "force-along-program/hollow.ngc", "--cell",
      EXAMPLES / "force-along-program/cell.toml"],
     lambda file: robomill.forces(EXAMPLES / "force-along-program/forces.toml", program=EXAMPLES / "force-along-program/hollow.ngc",
                                          cell=EXAMPLES / "force-along-program/cell.toml")),
    (["joint", EXAMPLES / "joint-bar/assembly.toml", "--measured", "TIP"],
     lambda file: robomill.joint(EXAMPLES / "joint-bar/assembly.toml", measured=file)),
], ids=lambda one: "-".join(map(str, one[:1])) if isinstance(one, list) else "")
def test_same_bits(words, call, tmp_path):
    tip = tmp_path / "tip.uff"
    if "TIP" in words:
        robomill.couple(EXAMPLES / "joint-bar/soft.toml", output=tip)
    theirs = command_line(*[tip if word == "TIP" else word for word in words])
    ours = call(tip).to_dict()
    assert without_times(ours) == without_times(theirs)


def test_documents_are_attributes_and_arrays():
    lobes = robomill.lobes(LOBES)
    assert lobes.document == "lobes/1"
    assert isinstance(lobes.spindle_speed_rpm, np.ndarray) and not lobes.spindle_speed_rpm.flags.writeable
    assert lobes.limit[0].spindle_speed_rpm == lobes.to_dict()["limit"][0]["spindle_speed_rpm"]
    with pytest.raises(AttributeError, match="frozen"):
        lobes.method = "none"
    with pytest.raises(AttributeError, match="has no limits"):
        lobes.limits
    assert "lobes/1" in repr(lobes) and len(repr(lobes)) < 300
    assert lobes._repr_html_().startswith("<iframe srcdoc=")


def test_options_and_input_are_checked():
    with pytest.raises(TypeError, match="has no option spindle"):
        robomill.lobes(LOBES, spindle=3)
    with pytest.raises(robomill.InvalidInput, match="missing.toml"):
        robomill.lobes("missing.toml")
    with pytest.raises(robomill.InvalidInput) as caught:
        robomill.lobes(LOBES, at=[(-1, 1)])
    assert caught.value.field


def test_outputs_are_written(tmp_path):
    robomill.lobes(LOBES, output=tmp_path / "lobes.json")
    assert json.loads((tmp_path / "lobes.json").read_text())["document"] == "lobes/1"


def test_progress_is_reported_and_stops_the_work():
    seen = []
    robomill.plan(EXAMPLES / "new-tool/job.toml", progress=lambda task, share: seen.append((task, share)))
    assert seen and all(0 <= share <= 1 for _, share in seen)

    class Enough(Exception):
        pass

    def stop(task, share):
        raise Enough

    with pytest.raises(Enough):
        robomill.plan(EXAMPLES / "new-tool/job.toml", progress=stop)


SLOW = """
import sys, robomill
print("begins", flush=True)
try:
    robomill.lobes(sys.argv[1])
except KeyboardInterrupt:
    print("stopped")
"""


def test_ctrl_c_stops_long_work(tmp_path):
    slow = tmp_path / "slow.toml"
    slow.write_text(LOBES.read_text().replace("grid = [100, 40]", 'grid = [1000, 800]\noutput = "map"'))
    process = subprocess.Popen([sys.executable, "-c", SLOW, str(slow)], stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "begins\n"
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    said, _ = process.communicate(timeout=30)
    assert said == "stopped\n"


def test_every_verb_has_its_documentation():
    for name in ("plan", "frf", "modes", "couple", "joint", "lobes", "simulate", "explain", "forces", "coefficients", "stiffness", "cell_check", "smooth",
                 "calibrate"):
        function = getattr(robomill, name)
        assert "Parameters\n----------" in function.__doc__ and "Returns" in function.__doc__, name
