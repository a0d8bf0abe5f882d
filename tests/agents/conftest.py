"""A finished run of PPO that the tests of training look into."""

import pytest
from training import SMALL, run


@pytest.fixture(scope="session")
def ppo_run(tmp_path_factory):
    return run(*SMALL["ppo"], "--out", tmp_path_factory.mktemp("runs") / "ppo")
