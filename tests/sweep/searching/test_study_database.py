import pytest

optuna = pytest.importorskip("optuna")

from hyperleg_design.errors import InputError, OutputError  # noqa: E402
from hyperleg_design.sweep.searching.study_database import (  # noqa: E402
    OWN,
    OWNER,
    clear_errors,
    open_study,
    owner_of,
    take_up,
)


def opened(folder, digest="a", remedies=None):
    return open_study(
        f"sqlite:///{folder / 'study.db'}",
        "mass",
        objectives=["total_mass"],
        directions=["minimize"],
        seed=0,
        digest=digest,
        remedies=remedies,
    )


def test_a_study_is_opened_again_under_its_digest_alone(tmp_path):
    first = opened(tmp_path)
    first.tell(first.ask(), 1.0)
    assert len(opened(tmp_path).trials) == 1
    with pytest.raises(OutputError, match="choose another --name"):
        opened(tmp_path, digest="b")
    with pytest.raises(OutputError, match="mass in this database was begun otherwise"):
        opened(tmp_path, digest="b", remedies={"a": "was begun otherwise", "c": "no"})
    with pytest.raises(OutputError, match="choose another --name"):
        opened(tmp_path, digest="b", remedies={"c": "no"})


def test_only_the_owners_running_trials_are_asked_for_anew(tmp_path):
    study = opened(tmp_path)
    for owner in ("me", "you"):
        trial = study.ask()
        trial.suggest_float("x", 0.0, 1.0)
        trial.set_user_attr(OWN, owner)
    take_up(study, "me")
    states = [trial.state.name for trial in study.trials]
    assert states == ["PRUNED", "RUNNING", "WAITING"]
    assert study.ask().suggest_float("x", 0.0, 1.0) == study.trials[0].params["x"]


def test_a_folder_keeps_its_owner_and_says_when_the_name_is_damaged(tmp_path):
    assert owner_of(tmp_path) == owner_of(tmp_path)
    (tmp_path / "other").mkdir()
    assert owner_of(tmp_path / "other") != owner_of(tmp_path)
    (tmp_path / OWNER).write_text("[]")
    with pytest.raises(OutputError, match="is damaged"):
        owner_of(tmp_path)


def test_a_damaged_file_is_named_with_a_remedy(tmp_path):
    (tmp_path / "study.db").write_text("no database at all" * 100)
    with pytest.raises(InputError, match="delete this file where it is damaged") as caught:
        opened(tmp_path)
    assert f"{tmp_path}/study.db: does not serve" in str(caught.value)
    assert "sqlalche.me" not in str(caught.value)
    assert "--storage" not in str(caught.value)


def test_errors_hide_the_password_and_other_errors_pass():
    from sqlalchemy.exc import SQLAlchemyError

    with (
        pytest.raises(InputError, match="does not serve: no door") as caught,
        clear_errors("postgresql://me:secret@host/x"),
    ):
        raise SQLAlchemyError("no door")
    assert "secret" not in str(caught.value)
    with pytest.raises(ZeroDivisionError), clear_errors(""):
        raise ZeroDivisionError
