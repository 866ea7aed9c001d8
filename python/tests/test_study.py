"""Studies: by the verb, and as tasks of a Dask cluster; the bytes are the same."""
import csv
import json
import os
import pathlib
import random
import signal
import subprocess

import pytest

import robomill

PROGRAM = os.environ["ROBOMILL"]
TABLES = ["results.csv", "results.h5"]
CUT = (pathlib.Path(__file__).resolve().parents[2] / "testing/jobs/study/lobes.toml").read_text()
STUDY = """
[study]
job = "lobes"
base = "lobes.toml"
collect = ["limit@8000", "abs_mu@8000,1.0", "chatter_frequency@8000"]
chunk_points = 4
[[vary]]
key = "cut.radial_depth_mm"
range = [2, 8]
count = 30
[[vary]]
key = "tool.teeth"
values = [2, 3, 4]
"""
CHUNKS = 23


@pytest.fixture
def study(tmp_path):
    (tmp_path / "lobes.toml").write_text(CUT)
    (tmp_path / "study.toml").write_text(STUDY)
    return tmp_path / "study.toml"


def tables(folder):
    return [(folder / name).read_bytes() for name in TABLES]


@pytest.fixture(scope="module")
def cluster():
    distributed = pytest.importorskip("distributed")
    import dask

    # A worker's death is somebody's who is killed on purpose, time after time.
    with dask.config.set({"distributed.scheduler.allowed-failures": 100}), \
            distributed.LocalCluster(n_workers=3, threads_per_worker=1, processes=True, dashboard_address=None) as workers, \
            distributed.Client(workers) as client:
        yield client


def test_sweep_gives_what_the_program_gives(study, tmp_path):
    subprocess.run([PROGRAM, "sweep", str(study), "-o", str(tmp_path / "theirs")], check=True, capture_output=True)
    ours = robomill.sweep(study, tmp_path / "ours")
    assert tables(tmp_path / "ours") == tables(tmp_path / "theirs")
    assert ours.summary.startswith("90 points in 23 chunks of 4")
    for part in ("1/2", "2/2"):
        robomill.sweep(study, tmp_path / "shards", shard=part)
    for name in TABLES:
        robomill.sweep(study, tmp_path / "shards", merge=tmp_path / "shards" / name)
    assert tables(tmp_path / "shards") == tables(tmp_path / "theirs")


def test_a_list_is_a_value(study, tmp_path):
    head = STUDY.split("[[vary]]")[0] + '[[vary]]\nkey = "tool.pitch_deg"\n'
    study.write_text(head + "values = [[180, 180], [150, 210]]\n")
    robomill.sweep(study, tmp_path / "out")
    with (tmp_path / "out" / "results.csv").open(newline="") as table:
        rows = list(csv.DictReader(table))
    assert [json.loads(row["tool.pitch_deg"]) for row in rows] == [[180, 180], [150, 210]]
    assert [row["state"] for row in rows] == ["done", "done"]
    study.write_text(head + "values = [[180, 180],\n[150, { a = 1 }]]\n")
    with pytest.raises(robomill.InvalidInput, match=r"study.toml:10: vary\[1\].values\[2\]\[2\]: must be"):
        robomill.sweep(study, tmp_path / "other")
    study.write_text(head + "range = [[180, 180], [150, 210]]\ncount = 2\n")
    with pytest.raises(robomill.InvalidInput, match=r"vary\[1\].range: must be a list of finite numbers"):
        robomill.sweep(study, tmp_path / "other")


def test_a_cluster_gives_the_same_bytes(study, tmp_path, cluster):
    robomill.sweep(study, tmp_path / "threads")
    seen = []
    result = robomill.sweep(study, tmp_path / "cluster", client=cluster, progress=lambda task, share: seen.append(share))
    assert tables(tmp_path / "cluster") == tables(tmp_path / "threads")
    for chunk in (tmp_path / "threads" / "chunks").glob("[0-9]*.chunk"):
        assert (tmp_path / "cluster" / "chunks" / chunk.name).read_bytes() == chunk.read_bytes()
    assert len(seen) == CHUNKS and seen == sorted(seen) and seen[-1] == 1
    assert "90 points done" in result.summary
    seen.clear()
    robomill.sweep(study, tmp_path / "cluster", client=cluster, progress=lambda task, share: seen.append(share))
    assert not seen, "nothing is done twice"


def test_workers_that_are_killed_lose_nothing(study, tmp_path, cluster):
    robomill.sweep(study, tmp_path / "threads")
    choose = random.Random(1)
    killed = []

    def kill_some(task, share):
        if choose.random() < 0.4:
            pids = list(cluster.run(os.getpid, on_error="ignore").values())
            if pids:
                killed.append(choose.choice(pids))
                os.kill(killed[-1], signal.SIGKILL)

    robomill.sweep(study, tmp_path / "cluster", client=cluster, progress=kill_some)
    assert len(killed) > 3
    assert tables(tmp_path / "cluster") == tables(tmp_path / "threads")


def test_a_run_that_was_stopped_goes_on_on_a_cluster(study, tmp_path, cluster):
    class Stopped(Exception):
        pass

    def stop(task, share):
        if share > 0.4:
            raise Stopped

    with pytest.raises(Stopped):
        robomill.sweep(study, tmp_path / "cluster", client=cluster, progress=stop)
    there = {path.name: path.stat().st_ino for path in (tmp_path / "cluster" / "chunks").glob("[0-9]*.chunk")}
    assert 0 < len(there) < CHUNKS
    robomill.sweep(study, tmp_path / "cluster", client=cluster)
    robomill.sweep(study, tmp_path / "threads")
    assert tables(tmp_path / "cluster") == tables(tmp_path / "threads")
    assert there == {name: (tmp_path / "cluster" / "chunks" / name).stat().st_ino for name in there}


def test_what_a_cluster_cannot_do_is_said(study, tmp_path, cluster):
    with pytest.raises(TypeError, match="client goes without shard"):
        robomill.sweep(study, tmp_path / "out", client=cluster, shard="1/2")
    with pytest.raises(TypeError, match="needs output"):
        robomill.sweep(study, client=cluster)
    study.write_text(STUDY.replace("lobes.toml", "none.toml"))
    with pytest.raises(robomill.InvalidInput, match="none.toml"):
        robomill.sweep(study, tmp_path / "out", client=cluster)
