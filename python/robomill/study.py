"""Studies: the verb sweep, and the same chunks as tasks of a Dask cluster."""
import collections.abc
import functools
import os
import pathlib
import typing

from . import _robomill
from .results import Result
from .verbs import _run

if typing.TYPE_CHECKING:
    import distributed

__all__ = ["sweep"]
_AHEAD = 3  # tasks that wait for each thread of the cluster: few enough to hold a million chunks back, and no thread has to wait


@functools.lru_cache(maxsize=4)
def _chunks(study: str, fingerprint: str):
    """On a worker: the study is read once."""
    chunks = _robomill._StudyChunks(study)
    if chunks.fingerprint != fingerprint:
        raise _robomill.InvalidInput(f"{study}: is of another study on the worker; the study, a document or a file that it names, robomill or its version differ there")
    return chunks


def _task(study: str, fingerprint: str, chunk: int, chunk_points: int) -> bytes:
    return _chunks(study, fingerprint).bytes_of(chunk, chunk_points)


def _on_cluster(study: str, output: str, client: "distributed.Client", retries: int, progress) -> None:
    """Does the chunks that are missing; each is saved here as it comes."""
    import distributed

    with _robomill._StudyFolder(study, output) as folder:
        todo = iter(folder.todo)
        left = done = len(folder.todo)
        name = f"robomill-sweep-{pathlib.Path(study).stem}"
        tries: dict[int, int] = {}
        chunk_of: dict[distributed.Future, int] = {}
        waiting = distributed.as_completed()

        def submit(chunk: int) -> None:
            tries[chunk] = tries.get(chunk, 0) + 1
            future = client.submit(_task, study, folder.fingerprint, chunk, folder.chunk_points, pure=False, retries=0,
                                   key=f"{name}-{folder.fingerprint[:8]}-{chunk}-{tries[chunk]}-{os.urandom(4).hex()}")
            chunk_of[future] = chunk
            waiting.add(future)

        def submit_more() -> None:
            while len(chunk_of) < _AHEAD * max(1, sum(client.nthreads().values())):
                chunk = next(todo, None)
                if chunk is None:
                    return
                submit(chunk)

        try:
            submit_more()
            for future in waiting:
                chunk = chunk_of.pop(future)
                error = future.exception() if future.status != "finished" else None
                if error is None and future.status == "finished":
                    folder.save(chunk, future.result())
                    left -= 1
                    if progress is not None:
                        progress("chunks", 1 - left / done)
                elif isinstance(error, _robomill.InvalidInput) or tries[chunk] > retries:
                    raise error if error is not None else RuntimeError(f"chunk {chunk} was cancelled")
                else:  # its worker died, or the cluster lost it
                    submit(chunk)
                future.release()
                submit_more()
        finally:
            client.cancel(list(chunk_of), force=True)


def sweep(study: str | os.PathLike[str], output: str | os.PathLike[str] | None = None, *, client: "distributed.Client | None" = None,
          retries: int = 10, shard: str | None = None, status: bool | None = None, dry_run: bool | None = None, slurm: bool | None = None,
          merge: str | os.PathLike[str] | None = None, progress: collections.abc.Callable[[str, float], object] | bool | None = None) -> Result:
    """A job done for many values of its document's keys, by the threads of this process, a Slurm cluster or a Dask cluster.

    The bytes of the results do not depend on which.

    Parameters
    ----------
    study : path
        study.toml: a job, its document, what varies and what is kept
    output : path
        the folder of the study; a run that was ended goes on there
    client : distributed.Client, optional
        of a Dask cluster: each chunk is a task on one thread. Workers have the same version of robomill, and see the study's files
        by the same paths; results come back to the client, which saves them, so that workers need not see the folder
    retries : int, default: 10
        of a chunk whose worker died
    shard : str, optional
        do each n-th chunk from the i-th on: "i/n"; not with `client`
    status : bool, optional
        how far the folder is; nothing is done
    dry_run : bool, optional
        one point, and what all would take; nothing is written
    slurm : bool, optional
        submit the shards as a job array of Slurm, by [slurm] of the study
    merge : path, optional
        write the points into this table, .h5 or .csv; no chunk is done
    progress : callable(str, float) or True, optional
        called with a task and the share that is done; True: a bar of tqdm

    Returns
    -------
    Result
        how far the study is

    Raises
    ------
    InvalidInput
        naming file, line or field, value, unit and rule
    KeyboardInterrupt
        when Ctrl-C is pressed; chunks that are done stay

    Notes
    -----
    On the command line:

        robomill sweep study.toml -o study/
    """
    verb = next(one for one in _robomill._verbs() if one["name"] == "sweep")
    options = {"shard": shard, "status": status, "dry_run": dry_run, "slurm": slurm, "merge": merge}
    if client is not None:
        given = [name for name, value in options.items() if value]
        if given:
            raise TypeError(f"client goes without {given[0]}")
        if output is None:
            raise TypeError("client needs output, the folder of the study")
        from .verbs import _progress

        _on_cluster(os.path.abspath(study), os.fspath(output), client, retries, _progress(progress))
    return _run([verb], study, output, progress if client is None else None, options)
