"""The database that a search's trials lie in, its errors, and what a killed run left in it."""

from __future__ import annotations

import json
import re
import uuid
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from hyperleg_design.errors import InputError, OutputError, in_short

if TYPE_CHECKING:
    import optuna

DATABASE, OWNER = "study.db", "search.json"
"""Files beside the results: the database, and the name of those who search into the folder."""
SQLITE = "sqlite:///"
"""Beginning of the address of a database that is a file."""
OWN = "owner"
"""Attribute of a trial: who runs it."""


@contextmanager
def clear_errors(url: str) -> Iterator[None]:
    """Give errors of a database as one clear error, without the password.

    Args:
        url: of the database.

    Yields:
        Nothing.

    Raises:
        InputError: the database refuses or is corrupt.
    """
    from sqlalchemy.exc import SQLAlchemyError

    try:
        yield
    except (SQLAlchemyError, ImportError) as error:
        reason = in_short(getattr(error, "orig", None) or error, 160)
        if url.startswith(SQLITE):
            remedy = f"does not serve as a database ({reason}); choose another folder, or delete "
            remedy += "this file where it is damaged"
            raise InputError(url, "", None, remedy) from None
        raise InputError(
            "--storage", "", re.sub(r"//[^@/]*@", "//...@", url), f"does not serve: {reason}"
        ) from None


def open_study(
    storage: str,
    name: str,
    *,
    objectives: Sequence[str],
    directions: Sequence[str],
    seed: int,
    digest: str,
    remedies: Mapping[str, str] | None = None,
) -> optuna.Study:
    """The study of a search in a database, made where it is not there.

    Args:
        storage: address of the database.
        name: of the study.
        objectives: full names of measures.
        directions: `minimize` or `maximize` for each objective.
        seed: of the sampler.
        digest: fingerprint of the search, which the study keeps.
        remedies: what an error says of a study that holds another fingerprint, by fingerprint.

    Returns:
        The study.

    Raises:
        InputError: Optuna is not installed, or the database refuses or is corrupt.
        OutputError: the database holds another search under this name.
    """
    try:
        import optuna
    except ImportError:
        raise InputError("search", "", None, "needs hyperleg-design[search] (optuna)") from None
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    warnings.simplefilter("ignore", optuna.exceptions.ExperimentalWarning)
    with clear_errors(storage):
        try:
            study = optuna.create_study(
                storage=storage,
                study_name=name,
                load_if_exists=True,
                directions=directions,
                sampler=optuna.samplers.TPESampler(seed=seed),
            )
        except ValueError:  # other directions
            study = None
        if study is not None and "digest" not in study.user_attrs:
            study.set_metric_names(list(objectives))
            study.set_user_attr("digest", digest)
        if study is None or study.user_attrs["digest"] != digest:
            known = (remedies or {}).get(study.user_attrs["digest"] if study else "")
            reason = known or (
                "is of another space, plan, objective or constraint; choose another --name"
            )
            raise OutputError(f"the study {name} in this database {reason}")
    return study


def owner_of(folder: Path) -> str:
    """Name of those who search into a folder, by which a later run knows its own trials.

    Args:
        folder: of the results; the name is written there where there is none.

    Returns:
        The name.

    Raises:
        OutputError: the file that holds the name is damaged.
    """
    path = folder / OWNER
    if not path.exists():
        path.write_text(json.dumps({OWN: uuid.uuid4().hex}))
    try:
        return str(json.loads(path.read_text())[OWN])
    except (ValueError, KeyError, TypeError):
        raise OutputError(f"{path}: is damaged; delete it") from None


def take_up(study: optuna.Study, owner: str) -> None:
    """Run again what a killed run of the same folder left unfinished.

    Args:
        study: whose running trials are given up and asked for anew.
        owner: those who search into the folder; trials of others go on.
    """
    import optuna

    running = (optuna.trial.TrialState.RUNNING,)
    for trial in study.get_trials(deepcopy=False, states=running):
        if trial.user_attrs.get(OWN) == owner:
            study.tell(trial.number, state=optuna.trial.TrialState.PRUNED)
            study.enqueue_trial(trial.params)
