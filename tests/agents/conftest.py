"""A finished run of PPO that the tests of training look into."""

import pytest
from training import SMALL, run

from agents.learning import learn


@pytest.fixture
def few_validation_episodes(monkeypatch):
    monkeypatch.setattr(learn, "VALIDATION_EPISODES", 2)


@pytest.fixture(scope="session")
def ppo_run(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(learn, "VALIDATION_EPISODES", 2)
        return run("--timesteps", 600, "--out", tmp_path_factory.mktemp("runs") / "ppo", *SMALL["ppo"])
