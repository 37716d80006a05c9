"""The folder of an experiment: whether it may be begun there, or gone on with, and by whom."""

from __future__ import annotations

import fcntl
import json
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import mala_drake
from mala_drake.errors import BadInput
from mala_drake.experiments.durable_files import TEMPORARY, replace_durably, writing
from mala_drake.experiments.experiment import Experiment, RunName
from mala_drake.experiments.run_summary import SUMMARY_FILE
from mala_drake.fingerprint import fingerprint

EXPERIMENT_FILE = "experiment.json"
"""Says what was begun in a folder."""

_LOCK_FILE = ".lock"
_OWN_FILES = (_LOCK_FILE, EXPERIMENT_FILE + TEMPORARY)


def begun_in(folder: Path) -> Experiment | None:
    """The experiment that was begun in a folder and can be gone on with, or None.

    Raises:
        BadInput: when its file cannot be read, or it was begun by other code, or with other models or domains, than are
            here now.
    """
    path = folder / EXPERIMENT_FILE
    if not path.exists():
        return None
    data = _read(path)
    if isinstance(data, dict):
        _refuse_other_code(data, path)
    return Experiment.from_json(data, where=str(path))


def _runs_in(folder: Path) -> tuple[RunName, ...]:
    """The runs that were begun in a folder, whether or not this version knows the scenario that they are of."""
    path = folder / EXPERIMENT_FILE
    data = _read(path)
    known = {**data, "scenario": {}} if isinstance(data, dict) else data
    return Experiment.from_json(known, where=str(path)).runs


def _refuse_other_code(data: dict[str, Any], path: Path) -> None:
    """Results of two states of the code, or of the user's own ward map, are not those of one experiment.

    Whoever wrote no fingerprint is from before there were any: other code, too.
    """
    scenario = data.get("scenario")
    ward = scenario.get("ward", "") if isinstance(scenario, dict) else ""
    begun, now = data.get("fingerprint"), fingerprint(str(ward))
    if begun == now:
        return
    what = f"begun with other code or models (fingerprint {begun or 'not kept yet'}, version {data.get('version')})"
    expected = f"the installation it was begun with rather than {now}, version {mala_drake.__version__}"
    raise BadInput(str(path), what, f"{expected}; --overwrite begins anew")


def _read(path: Path) -> Any:
    try:
        return json.loads(path.read_bytes())
    except OSError as error:
        raise BadInput(str(path), f"cannot be read ({error.strerror})", "a readable file") from None
    except ValueError:
        raise BadInput(str(path), "is not JSON", "the file that the experiment has made") from None


@contextmanager
def experiment_folder(
    folder: Path, experiment: Experiment, *, resume: bool = False, overwrite: bool = False
) -> Iterator[None]:
    """Holds the folder for this process alone, with the experiment begun in it.

    Args:
        folder: made if it is missing.
        experiment: to be begun or gone on with.
        resume: whether to go on with what is there; where there is nothing, the experiment is begun.
        overwrite: whether to remove what an experiment has left there before.

    Raises:
        BadInput: when the folder is not empty and neither option allows for it, when it holds something else than this
            experiment by this code, or when another process writes there.
    """
    with _held(folder):
        if overwrite or not (folder / EXPERIMENT_FILE).exists():
            _make_room(folder, resume=resume)
            replace_durably(folder / EXPERIMENT_FILE, json.dumps(experiment.to_json(), indent=2) + "\n")
        elif not resume:
            raise BadInput(str(folder), "holds an experiment", "--resume to go on with it, or --overwrite")
        elif begun := begun_in(folder):
            refuse_differences(begun, experiment, folder)
        for outdated in (folder / SUMMARY_FILE, folder / f"{experiment.name}.md"):
            with writing(outdated):
                outdated.unlink(missing_ok=True)
        yield


@contextmanager
def _held(folder: Path) -> Iterator[None]:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(folder / _LOCK_FILE, os.O_RDWR | os.O_CREAT, 0o666)
    except OSError as error:
        raise BadInput(str(folder), f"cannot be written ({error.strerror})", "a writable folder") from None
    try:
        # The lock falls when the process ends, killed or not.
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(descriptor)
        raise BadInput(str(folder), "another process writes there", "a folder of its own, or to wait") from None
    try:
        yield
    finally:
        os.close(descriptor)


def _make_room(folder: Path, *, resume: bool) -> None:
    """Removes what an experiment has left; refuses a folder with anything in it that is no experiment's."""
    if (folder / EXPERIMENT_FILE).exists():
        for run in _runs_in(folder):
            shutil.rmtree(folder / run.folder, ignore_errors=True)
        return
    others = sorted(path.name for path in folder.iterdir() if path.name not in _OWN_FILES)
    if others:
        expected = "the folder of an experiment" if resume else "an empty folder, or a new one"
        raise BadInput(str(folder), f"has {others[0]} in it and is no experiment's", expected)


def refuse_differences(begun: Experiment, asked: Experiment, folder: Path) -> None:
    """Refuses to go on with another experiment than the one that was begun.

    Raises:
        BadInput: naming the first difference.
    """
    difference = _difference(begun.to_json(), asked.to_json(), "")
    if difference is not None:
        name, old, new = difference
        raise BadInput(name, json.dumps(new), f"{json.dumps(old)}, with which {folder} was begun")


def _difference(old: Any, new: Any, at: str) -> tuple[str, Any, Any] | None:
    """Where two nested mappings differ first, and what is there."""
    if old == new:
        return None
    if isinstance(old, dict) and isinstance(new, dict):
        for key in dict.fromkeys((*old, *new)):
            if found := _difference(old.get(key), new.get(key), f"{at}.{key}" if at else key):
                return found
    return at, old, new
