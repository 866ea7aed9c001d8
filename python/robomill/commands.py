"""Verbs that are no job with a document: `init` by the library; the monitor and the server by the program `robomill`, each in a
process of its own."""
import collections.abc
import json
import os
import pathlib

import numpy as np

from . import _robomill
from .results import Result

__all__ = ["Served", "init", "monitor_input", "serve_folder"]
_ITS_INPUT = (1, 2)  # the program's exit codes for bad input and wrong usage


def _program() -> str:
    import shutil

    name = os.environ.get("ROBOMILL", "robomill")
    found = shutil.which(name)
    if found is None:
        raise FileNotFoundError(f"{name}: the program is not there; install it, or name it by the environment variable ROBOMILL")
    return found


def _error(said: str) -> ValueError:
    return _robomill.InvalidInput(said.strip().removeprefix("robomill: ") or "the program ended without a message")


def init(kind: str, output: str | os.PathLike[str] | None = None, *, example: bool = False, data: str | os.PathLike[str] | None = None,
         robot: str = "") -> Result:
    """A commented file in which what only you know is to be filled in, and the files that it names.

    Columns and directions of recorded hits are guessed, and marked as guessed.

    Parameters
    ----------
    kind : str, one of job, hits, lobes, cell, assembly, forces, monitor
        what the file describes
    output : path, default: KIND.toml in the current folder
        the file, or a folder for it; nothing that exists is overwritten
    example : bool, default: False
        made-up values that run as they are, each listed as assumed until changed
    data : path, default: the folder of the file
        of hits and job: a folder with recorded hits
    robot : str, default: ""
        of a cell: an arm by its name, "kuka-kr210-r2700" for one

    Returns
    -------
    Result
        `files` that were written, those that were there and were `kept`, `notes` on records that were found, and what is to be run
        `next`

    Raises
    ------
    InvalidInput
        if a file exists, the kind or the robot is not known, or the folder of data cannot be read
    """
    jobs = _robomill.jobs
    try:
        options = jobs.InitOptions(kind=kind, file=os.fspath(output or ""), data=os.fspath(data or ""), robot=robot, example=example)
    except TypeError:
        raise _robomill.InvalidInput(f"kind = {kind}; must be one of {', '.join(jobs.Template.__members__)}") from None
    files = jobs.init_files(options=options)
    jobs.write_init(files=files)
    document = {"files": [str(one.path) for one in files.files], "kept": [str(one) for one in files.kept], "notes": list(files.notes), "next": files.next}
    lines = [*(f"wrote {one}" for one in document["files"]), *(f"kept  {one}" for one in document["kept"]), *files.notes, f"Run: robomill {files.next}"]
    return Result(document, "\n".join(lines) + "\n")


def monitor_input(monitor: str | os.PathLike[str], *, input: str | os.PathLike[str] | collections.abc.Sequence[str | os.PathLike[str]] | None = None,
                  samples=None, every_window: bool = False, why: bool = False, seconds: float | None = None,
                  output: str | os.PathLike[str] | None = None, report: str | os.PathLike[str] | None = None) -> Result:
    """A recording to the events of the chatter monitor, by the program `robomill monitor`.

    The environment variable ROBOMILL names the program where it is not on PATH. `robomill.monitor.ChatterMonitor` decides in this
    process, hop by hop, without the advice on modes and speeds.

    Parameters
    ----------
    monitor : path
        monitor.toml: channels, process, detector
    input : path or sequence of paths
        a recording, several where its channels are in files of their own, or "mqtt://HOST:PORT/TOPIC"; default: mqtt.topic of
        monitor.toml
    samples : array_like
        in the place of `input`: n samples, or n x channels, in the unit of the channels divided by signal.scale; monitor.toml has
        their rate
    every_window : bool, default: False
        an event each hop, not only on change
    why : bool, default: False
        each change of state, and each window, with its test, values and thresholds
    seconds : float
        process so much of the stream, then end; a stream of a broker ends by nothing else
    output : path
        the events, a line of JSON each: .jsonl
    report : path
        the page of the recording: .html

    Returns
    -------
    Result
        `events`: as lines of events.jsonl have them (docs/formats.md, "Events")

    Raises
    ------
    InvalidInput
        as the program says it
    FileNotFoundError
        if the program is not there
    """
    import subprocess
    import tempfile

    words = [_program(), "monitor", os.fspath(monitor)]
    if input is not None and samples is not None:
        raise TypeError("give input or samples, not both")
    for one in [input] if isinstance(input, (str, os.PathLike)) else input or []:
        words += ["--input", os.fspath(one)]
    words += ["--every-window"] * every_window + ["--why"] * why
    words += ["--seconds", repr(float(seconds))] if seconds is not None else []
    words += ["--report", os.fspath(report)] if report is not None else []
    with tempfile.TemporaryDirectory() as folder:
        events = pathlib.Path(output if output is not None else pathlib.Path(folder) / "events.jsonl")
        words += ["-o", os.fspath(events)]
        raw = pathlib.Path(folder) / "samples.f32"
        if samples is not None:
            np.ascontiguousarray(samples, dtype="<f4").tofile(raw)
            words += ["--input", os.fspath(raw), "--format", "f32"]
        done = subprocess.run(words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        if done.returncode != 0:
            raise _error(done.stderr) if done.returncode in _ITS_INPUT else RuntimeError(f"robomill ended with {done.returncode}: {done.stderr}")
        return Result({"events": [json.loads(line) for line in events.read_text(encoding="utf-8").splitlines()]}, done.stdout)


class Served:
    """A folder that the program `robomill serve` serves, until stop() or the end of a `with`.

    Attributes
    ----------
    address : str
        of the page: "http://127.0.0.1:8437/"
    """

    def __init__(self, process, address: str) -> None:
        self._process = process
        self.address = address

    def stop(self) -> None:
        """Ends the server, and jobs that run."""
        if self._process.poll() is None:
            self._process.terminate()
        self._process.communicate()

    def __enter__(self) -> "Served":
        return self

    def __exit__(self, *what: object) -> None:
        self.stop()

    def __repr__(self) -> str:
        return f"<robomill serve at {self.address}>" if self._process.poll() is None else "<robomill serve, ended>"


def serve_folder(folder: str | os.PathLike[str] = ".", *, port: int = 0, host: str = "127.0.0.1", token_file: str | os.PathLike[str] | None = None,
                 job_memory_mb: int | None = None) -> Served:
    """The page of a folder over HTTP, by the program `robomill serve` in a process of its own.

    The environment variable ROBOMILL names the program where it is not on PATH.

    Parameters
    ----------
    folder : path, default: the current folder
        what is served, and nothing outside it
    port : int, default: 0
        to listen at; 0: any that is free
    host : str, default: "127.0.0.1"
        address to listen at; one that other machines reach needs a token
    token_file : path
        a file that has the token alone
    job_memory_mb : int, default: half of the machine's memory
        that a job may have

    Returns
    -------
    Served
        its `address`; it is stopped by `stop()` or the end of a `with`

    Raises
    ------
    InvalidInput
        as the program says it
    FileNotFoundError
        if the program is not there
    """
    import subprocess
    import tempfile

    words = [_program(), "serve", os.fspath(folder), "--port", str(port), "--host", host, "--quiet"]
    words += ["--token-file", os.fspath(token_file)] if token_file is not None else []
    words += ["--job-memory-mb", str(job_memory_mb)] if job_memory_mb is not None else []
    with tempfile.TemporaryFile(mode="w+") as said:  # a pipe that nobody reads would stop the server when it is full
        process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=said, text=True)
        assert process.stdout is not None  # for type checkers
        address = process.stdout.readline().strip()
        if not address:
            process.communicate()
            said.seek(0)
            raise _error(said.read())
        return Served(process, address)
