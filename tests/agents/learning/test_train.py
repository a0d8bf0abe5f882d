"""Training runs of a few hundred steps: what they leave behind, how they resume, what they refuse."""

import csv
import json
import sys
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest
import torch
from stable_baselines3.common.logger import Logger
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from agents import evaluate as evaluate_module
from agents import runs
from agents.arguments import parse_arguments
from agents.comparison.suites import SUITES
from agents.environments import make_env
from agents.evaluate import evaluate
from agents.laws.baselines import load_parameters, make_baseline
from agents.laws.residual import ResidualController
from agents.learning import configurations, learn
from agents.learning.callbacks import DeploymentLogger
from agents.torque_laws import OpenLoopParameters, OpenLoopTorque, Signals
from solar_env.array import MODELS
from solar_env.support.campaigns import Workers

sys.path.insert(0, str(Path(__file__).parents[3]))
import train

RIGID = ["--model", "rigid-clearance"]
OFF_POLICY = [*RIGID, "--n-envs", "1", "--landings", "4"]
OFF_POLICY += ["--hyperparams", "learning_starts=50", "buffer_size=2000", "batch_size=32"]
OFF_POLICY += ["train_freq=50", "gradient_steps=2"]
SMALL = {
    "ppo": [*RIGID, "--n-envs", "2", "--landings", "4", "--hyperparams", "n_steps=300", "batch_size=100"],
    "sac": OFF_POLICY,
    "td3": OFF_POLICY,
}


def run(*arguments):
    args = parse_arguments(train.Args, ["--quiet", "--eval-episodes", "2", *map(str, arguments)])
    return train.main(args, "python train.py ...")


@pytest.fixture(scope="module", autouse=True)
def few_validation_episodes():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(learn, "VALIDATION_EPISODES", 2)
        yield


@pytest.fixture(scope="module")
def ppo_run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs") / "ppo"
    return run("--timesteps", 600, "--out", folder, *SMALL["ppo"])


@pytest.mark.parametrize(
    ("arguments", "model", "elements", "timesteps"),
    [
        ([], "flexible-clearance", 2, 86_400),
        (["--elements", "4", "--timesteps", "500"], "flexible-clearance", 4, 500),
        (["--algo", "sac"], "flexible-clearance", 2, 86_400),
        (["--model", "flexible-clearance"], "flexible-clearance", None, 216_000),
        (["--env-kwargs", "model=rigid-clearance"], "rigid-clearance", None, 216_000),
        (["--residual", "0"], "rigid-clearance", None, 432_000),
    ],
)
def test_a_short_training_on_flexible_panels_unless_a_model_is_named_or_there_is_no_law(
    arguments, model, elements, timesteps
):
    config = train.configuration(parse_arguments(train.Args, arguments), seed=0)
    assert (config.env_kwargs["model"], config.env_kwargs.get("elements")) == (model, elements)
    assert config.timesteps == timesteps


@pytest.mark.filterwarnings("ignore:no parameters of .* have been tuned")
@pytest.mark.parametrize("model", MODELS)
def test_a_run_keeps_its_model_and_elements_and_is_resumed_and_evaluated_on_them(tmp_path, model):
    quick = ["--env-kwargs", "deadline=0.5", "postlock_window=0.2", "--n-envs", "1", "--residual", 0]
    small = ["--timesteps", 20, "--hyperparams", "n_steps=10", "batch_size=10"]
    elements = 1 if model.startswith("flexible") else None
    mesh = ["--elements", elements] if elements else []
    first = run("--model", model, *mesh, *quick, *small, "--out", tmp_path / "first")
    config = runs.read_config(first)
    assert (config["env_kwargs"]["model"], config["env_kwargs"].get("elements")) == (model, elements)
    assert evaluate_module.common_env_kwargs([str(first)])["model"] == model
    second = run("--resume", first, "--model", model, "--timesteps", 10, "--out", tmp_path / "second")
    assert runs.read_config(second)["env_kwargs"] == config["env_kwargs"]
    with pytest.raises(ValueError, match=f"--elements 2 contradicts the run to resume, which has {elements or 6}"):
        run("--resume", first, "--elements", 2, "--out", tmp_path / "third")


@pytest.mark.parametrize("law", ["servo", "soft-start"])
def test_a_residual_agent_starts_as_the_law_it_adds_to_and_the_run_keeps_that_law(tmp_path, law):
    small = ["--timesteps", 20, "--n-envs", 1, "--hyperparams", "n_steps=10", "batch_size=10", "learning_rate=0.0"]
    folder = run(*RIGID, "--residual", 0.3, "--law", law, "--landings", 4, *small, "--out", tmp_path / "run")
    residual = runs.read_config(folder)["residual"]
    env = make_env()
    assert residual["law"] == law
    assert residual["scale"] == 0.3
    assert residual["parameters"] == runs.jsonable(
        asdict(load_parameters(law, "solar_env/Deploy-v0", "rigid-clearance"))
    )
    observations = env.observation_space.sample()[None] * np.linspace(0.0, 1.0, 20)[:, None].astype(np.float32)
    base = make_baseline(law, env).predict(observations)[0]
    assert np.array_equal(runs.load_policy(folder, env).predict(observations, deterministic=True)[0], base)
    trained = ResidualController(
        OpenLoopTorque(Signals.of(env), OpenLoopParameters((0.2,) * 16)), residual, Signals.of(env)
    )
    np.testing.assert_allclose(trained.predict(observations)[0], np.clip(base + 0.3 * 0.4, -1.0, 1.0), atol=1e-6)


@pytest.mark.parametrize("algo", ["ppo", "sac", "td3"])
def test_a_fresh_agent_adds_nothing_to_a_law_but_is_not_held_back_without_one(algo):
    small = {"batch_size": 300} if algo == "ppo" else {"buffer_size": 100}
    config = configurations.configuration(
        algo, "solar_env/Deploy-v0", {}, 0, n_envs=1, hyperparameters=small, residual=0.2, landings=4
    )
    venv = learn.make_training_env(config, [], None, threads=1)
    space = venv.observation_space
    observations = np.random.default_rng(0).uniform(space.low, space.high, (2000, *space.shape)).astype(np.float32)
    without = replace(config, residual=None)
    added, whole = (
        learn.make_model(c, venv, learn.prepare(c)[0]).predict(observations, deterministic=True)[0]
        for c in (config, without)
    )
    assert not added.any()
    assert whole.any()


@pytest.mark.parametrize("algo", ["ppo", "sac", "td3"])
def test_an_agent_adds_nothing_to_a_law_where_it_has_no_features_however_long_it_trains(tmp_path, algo):
    few = {"train_freq": 50, "gradient_steps": 2, "buffer_size": 2000, "batch_size": 32}
    small = {"batch_size": 100, "n_steps": 300} if algo == "ppo" else few
    config = configurations.configuration(
        algo, "solar_env/Deploy-v0", {}, 0, n_envs=1, timesteps=600, hyperparameters=small, residual=0.3, landings=4
    )
    learn.train(config, tmp_path, progress=False)
    venv = learn.make_training_env(config, [], None, threads=1)
    resumed = learn.load_checkpoint(config, tmp_path, venv)
    resumed.learn(600)
    before = runs.algorithm(algo).load(tmp_path / "checkpoint" / "model.zip")
    folded = np.zeros((1, *venv.observation_space.shape), dtype=np.float32)
    latched = np.ones_like(folded)
    latched[:, venv.get_attr("observation_names", 0)[0].index("time_since_latch")] = 0.0
    for agent in (before, resumed):
        assert not agent.predict(folded, deterministic=True)[0].any()
        assert agent.predict(latched, deterministic=True)[0].any()


def test_the_learning_rate_of_ppo_falls_from_update_to_update_and_none_is_without_effect():
    rollouts = {"n_steps": 50, "batch_size": 50, "learning_rate": 1e-3}
    quick = {"model": "rigid-ideal"}
    config = configurations.configuration("ppo", "solar_env/Deploy-v0", quick, 0, 2, 400, rollouts, residual=0.0)
    model = learn.make_model(config, learn.make_training_env(config, [], None, threads=1), learn.prepare(config)[0])
    used = []
    update = model.train
    model.train = lambda: (update(), used.append(model.policy.optimizer.param_groups[0]["lr"]))
    model.learn(config.timesteps)
    assert used == pytest.approx([1e-3, 0.75e-3, 0.5e-3, 0.25e-3])


@pytest.mark.parametrize("algo", ["sac", "td3"])
def test_agents_with_a_replay_buffer_learn_from_returns_over_many_periods_and_ever_more_slowly(algo, tmp_path):
    small = {"batch_size": 32, "buffer_size": 2000, "learning_rate": 1e-3, "n_steps": 7}
    small |= {"train_freq": 20, "gradient_steps": 2}
    config = configurations.configuration(algo, "solar_env/Deploy-v0", {}, 0, 1, 40, small, residual=0.3, landings=1)
    learn.train(config, tmp_path, progress=False)
    resumed = learn.load_checkpoint(config, tmp_path, learn.make_training_env(config, [], None, threads=1))
    assert (resumed.replay_buffer.n_steps, resumed.replay_buffer.gamma) == (7, config.hyperparameters["gamma"])
    assert [resumed.lr_schedule(left) for left in (1.0, 0.5, 0.0)] == pytest.approx([1e-3, 0.5e-3, 0.0])


@pytest.mark.filterwarnings("ignore:no parameters of .* have been tuned")
@pytest.mark.parametrize("algo", ["sac", "td3"])
def test_the_actor_learns_at_a_rate_of_its_own_in_a_resumed_run_too(algo, tmp_path):
    small = {"batch_size": 32, "buffer_size": 2000, "learning_starts": 0, "learning_rate": 1e-2}
    small |= {"train_freq": 100, "gradient_steps": 1, "actor_learning_rate": 1e-4}
    small |= {"policy_delay": 1} if algo == "td3" else {}
    made = "solar_env/Deploy-v0", {"model": "rigid-ideal"}, 0, 1
    config = configurations.configuration(algo, *made, 200, small, residual=0.3, landings=1)
    learn.train(config, tmp_path, progress=False)
    resumed = learn.load_checkpoint(config, tmp_path, learn.make_training_env(config, [], None, threads=1))
    networks = resumed.policy.actor.mu, resumed.policy.critic
    before = [[weights.clone() for weights in network.parameters()] for network in networks]
    resumed.lr_schedule = lambda left: 1e-2
    resumed.set_logger(Logger(None, []))
    resumed.train(1, 32)
    actor, critic = (
        max(float((new - old).detach().abs().max()) for new, old in zip(network.parameters(), weights, strict=True))
        for network, weights in zip(networks, before, strict=True)
    )
    assert 1e-5 < actor < 2e-4
    assert 1e-3 < critic < 2e-2


@pytest.mark.parametrize("algo", ["ppo", "sac"])
def test_noise_on_the_weights_stays_for_a_hundred_periods(algo):
    """Stable-Baselines3 draws it anew at the beginning of every rollout too, which for SAC can be every step."""
    quick = {"batch_size": 300} if algo == "ppo" else {"batch_size": 32, "gradient_steps": 1}
    config = configurations.configuration(
        algo, "solar_env/Deploy-v0", {}, 0, n_envs=1, hyperparameters=quick, residual=0.3, landings=1
    )
    model = learn.make_model(config, learn.make_training_env(config, [], None, threads=1), learn.prepare(config)[0])
    actor = model.policy if algo == "ppo" else model.actor
    drawn = []
    model.learn(300, callback=lambda *_: drawn.append(actor.action_dist.exploration_matrices.clone()) is None)
    assert len(drawn) == 300
    changes = [k for k in range(1, 300) if not torch.equal(drawn[k - 1], drawn[k])]
    assert changes == [100, 200]


def test_td3_explores_with_the_noise_it_is_told_which_forgets_within_a_hundred_periods():
    quick = {"exploration_noise": 0.4, "buffer_size": 100}
    config = configurations.configuration("td3", "solar_env/Deploy-v0", {}, 0, 1, None, quick, residual=0.0)
    model = learn.make_model(config, learn.make_training_env(config, [], None, threads=1), learn.prepare(config)[0])
    np.random.seed(0)  # noqa: NPY002 (what Stable-Baselines3 draws from)
    noise = np.array([model.action_noise()[0] for _ in range(200_000)])
    assert noise.std() == pytest.approx(0.4, rel=0.1)
    assert np.corrcoef(noise[:-100], noise[100:])[0, 1] == pytest.approx(np.exp(-1.0), abs=0.1)


def test_one_rollout_trains_too(ppo_run):
    config = configurations.stored_configuration(ppo_run)
    venv = learn.make_training_env(config, [], None, threads=1)
    fresh = learn.make_model(config, venv, learn.prepare(config)[0])
    trained = runs.algorithm("ppo").load(ppo_run / "checkpoint" / "model.zip")
    assert not torch.equal(fresh.policy.action_net.weight, trained.policy.action_net.weight)


def test_the_target_actor_of_a_fresh_td3_agent_is_its_actor():
    small = {"buffer_size": 100}
    config = configurations.configuration(
        "td3", "solar_env/Deploy-v0", {}, 0, n_envs=1, hyperparameters=small, residual=0.2, landings=4
    )
    venv = learn.make_training_env(config, [], None, threads=1)
    policy = learn.make_model(config, venv, learn.prepare(config)[0]).policy
    actor, target = (part.state_dict() for part in (policy.actor, policy.actor_target))
    assert all(torch.equal(actor[name], target[name]) for name in actor)


def test_training_takes_the_agents_action_as_an_addition_to_the_law():
    config = configurations.configuration("ppo", "solar_env/Deploy-v0", {}, seed=0, n_envs=2, residual=0.2)
    venv = learn.make_training_env(config, [], None, threads=1)
    plain = learn.make_training_env(replace(config, residual=None), [], None, threads=1)
    law = make_baseline("servo", make_env())
    venv.seed(3)
    plain.seed(3)
    observations = venv.reset()
    assert np.array_equal(observations, plain.reset())
    for k in range(12):
        added = np.full((2, 1), np.sin(k), dtype=np.float32)
        whole = np.clip(law.predict(observations)[0] + np.float32(0.2) * added, -1.0, 1.0)
        observations, *_ = venv.step(added)
        assert np.array_equal(observations, plain.step(whole)[0])


@pytest.mark.parametrize("scale", [-0.1, 1.5])
def test_a_residual_beyond_the_torque_limit_is_refused(tmp_path, scale):
    with pytest.raises(ValueError, match=f"residual = {scale}"):
        run("--residual", scale, "--out", tmp_path / "run")


def policy_weights(folder):
    model = runs.algorithm("ppo").load(folder / "checkpoint" / "model.zip")
    return np.concatenate([weights.detach().numpy().ravel() for weights in model.policy.parameters()])


def test_a_run_folder_holds_all_that_describes_the_run(ppo_run):
    expected = {
        "policy.zip",
        "checkpoint",
        "config.json",
        "monitor.csv",
        "evaluations.npz",
        "tensorboard",
        "episodes.csv",
        "metrics.json",
        "comparison.md",
        "figure.png",
        "timing.json",
    }
    assert {path.name for path in ppo_run.iterdir()} == expected
    config = json.loads((ppo_run / "config.json").read_text())
    assert config["hyperparameters"]["n_steps"] == 300
    assert config["command"] == "python train.py ..."
    assert config["versions"]["torch"]
    metrics = json.loads((ppo_run / "metrics.json").read_text())
    assert list(metrics["controllers"]) == ["passive", "servo-untuned", "servo", "ppo"]


def test_the_policy_is_validated_before_it_is_trained(ppo_run):
    with np.load(ppo_run / "evaluations.npz") as history:
        assert history["timesteps"].tolist() == [0, 600]
        assert history["results"].shape == (2, learn.VALIDATION_EPISODES)


def test_the_saved_policy_reproduces_the_evaluation_of_the_run(ppo_run):
    with (ppo_run / "episodes.csv").open() as file:
        written = [row for row in csv.DictReader(file) if row["controller"] == "ppo"]
    again = evaluate([str(ppo_run)], episodes=2, seed=0, progress=False)
    assert [float(row["return"]) for row in written] == [row["return"] for row in again]


def test_the_log_has_reward_terms_and_physical_figures(ppo_run):
    log = EventAccumulator(str(ppo_run / "tensorboard"))
    log.Reload()
    tags = set(log.Tags()["scalars"])
    assert {"deployment/peak_postlock_force_N", "deployment/postlock_sliding_work_J"} <= tags
    assert {"deployment/latch_times_s", "eval/mean_reward"} <= tags
    terms = [f"episode/reward_{name}" for name in ("peak_impact", "wear", "missed_deadline")]
    for event in zip(log.Scalars("episode/return"), *map(log.Scalars, terms), strict=True):
        total, *parts = (point.value for point in event)
        assert total == pytest.approx(sum(parts), rel=1e-5)


def test_the_same_seed_trains_the_same_policy_and_another_seed_another(ppo_run, tmp_path):
    same = run("--timesteps", 600, "--out", tmp_path / "same", *SMALL["ppo"])
    other = run("--timesteps", 600, "--out", tmp_path / "other", "--seed", 1, *SMALL["ppo"])
    np.testing.assert_array_equal(policy_weights(ppo_run), policy_weights(same))
    assert not np.array_equal(policy_weights(ppo_run), policy_weights(other))


def test_several_seeds_are_trained_side_by_side_each_as_alone_and_only_once(ppo_run, tmp_path):
    arguments = ["--timesteps", 600, "--seeds", 0, 1, "--jobs", 2, "--out", tmp_path, *SMALL["ppo"]]
    assert run(*arguments) == tmp_path
    np.testing.assert_array_equal(policy_weights(tmp_path / "seed-0"), policy_weights(ppo_run))
    assert not np.array_equal(policy_weights(tmp_path / "seed-1"), policy_weights(ppo_run))
    metrics = json.loads((tmp_path / "metrics.json").read_text())
    assert metrics["controllers"]["ppo"]["runs"] == 2
    written = (tmp_path / "seed-1" / "timing.json").stat().st_mtime_ns
    (tmp_path / "seed-0" / "timing.json").unlink()  # as if it had been interrupted
    run(*arguments)
    assert (tmp_path / "seed-0" / "timing.json").is_file()
    assert (tmp_path / "seed-1" / "timing.json").stat().st_mtime_ns == written
    (tmp_path / "seed-1" / "timing.json").unlink()
    with pytest.raises(ValueError, match="seed-1 holds a run with another configuration"):
        run("--timesteps", 600, "--seeds", 1, 0, "--out", tmp_path, *SMALL["ppo"], "learning_rate=0.5")
    assert (tmp_path / "seed-1" / "policy.zip").is_file(), "what was interrupted is not removed before all is checked"


def test_the_time_of_a_run_is_told_apart(ppo_run):
    timing = json.loads((ppo_run / "timing.json").read_text())
    parts = [timing[name] for name in ("preparing_s", "stepping_s", "validation_s", "learning_s")]
    assert min(parts) > 0.0
    assert sum(parts) == pytest.approx(timing["wall_time_s"])


def test_resuming_continues_step_count_normalisation_and_validation_history(ppo_run, tmp_path):
    resumed = run("--resume", ppo_run, "--timesteps", 600, "--out", tmp_path / "resumed")
    config = runs.read_config(resumed)
    assert config["resumed_from"] == str(ppo_run)
    assert config["timesteps_before"] == 600
    assert config["hyperparameters"]["n_steps"] == 300
    stored = runs.algorithm("ppo").load(resumed / "checkpoint" / "model.zip")
    assert stored.num_timesteps == 1200
    before, after = (normalisation_count(folder) for folder in (ppo_run, resumed))
    assert after == pytest.approx(before + 600, rel=1e-3)
    with np.load(ppo_run / "evaluations.npz") as old, np.load(resumed / "evaluations.npz") as new:
        assert new["timesteps"].tolist()[: len(old["timesteps"])] == old["timesteps"].tolist()
        assert new["timesteps"][-1] > 600


def normalisation_count(folder):
    config = configurations.configuration("ppo", "solar_env/Deploy-v0", {}, seed=0, n_envs=2)
    venv = learn.make_training_env(config, [], None)
    return learn.VecNormalize.load(str(folder / "checkpoint" / "vecnormalize.pkl"), venv).ret_rms.count


@pytest.mark.parametrize("algo", ["sac", "td3"])
def test_resuming_an_off_policy_run_continues_its_replay_buffer(tmp_path, algo):
    first = run("--algo", algo, "--timesteps", 300, "--out", tmp_path / "first", *SMALL[algo])
    second = run("--resume", first, "--timesteps", 100, "--out", tmp_path / "second")
    costs = [runs.read_config(folder)["residual"]["tuning_episodes"] for folder in (first, second)]
    assert costs[1] == costs[0] + 4  # landings that were recorded anew
    config = configurations.resumed_configuration(second)
    model = learn.load_checkpoint(config, second, learn.make_training_env(config, [], None))
    assert model.num_timesteps == 400
    assert model.replay_buffer.size() == 400
    buffer = model.replay_buffer
    ends = np.logical_or(buffer.dones, buffer.timeouts)[: buffer.pos]
    continues = np.all(
        np.isclose(buffer.next_observations[: buffer.pos - 1], buffer.observations[1 : buffer.pos]), axis=2
    )
    assert np.all(continues | ends[:-1]), "no return reaches from one episode into another"
    assert np.all(ends[-1]), "nor into what is collected next"


def test_a_resumed_run_sees_other_landings_than_the_first(ppo_run):
    first, resumed = (
        {landing.episode.parameters.hinge_x for landing in learn.prepare(config)[1]}
        for config in (configurations.stored_configuration(ppo_run), configurations.resumed_configuration(ppo_run))
    )
    assert len(first) == len(resumed) == 4
    assert first.isdisjoint(resumed)


def test_a_resumed_agent_of_the_whole_torque_sees_other_training_episodes_than_the_first(tmp_path):
    quick = {"n_steps": 10, "batch_size": 10}
    config = configurations.configuration(
        "ppo", "solar_env/Deploy-v0", {"model": "rigid-ideal"}, 0, 2, 20, quick, residual=0.0
    )
    learn.train(config, tmp_path, progress=False)
    seen = []
    for segment in (config, configurations.resumed_configuration(tmp_path)):
        venv = learn.make_training_env(segment, [], None, threads=1)
        if segment is config:
            model = learn.make_model(segment, venv, learn.prepare(segment)[0])
        else:
            model = learn.load_checkpoint(segment, tmp_path, venv)
        model.env.reset()
        seen.append({design.hinge_x for design in venv.get_attr("episode_parameters")})
    assert len(seen[0]) == len(seen[1]) == 2
    assert seen[0].isdisjoint(seen[1])


def test_ctrl_c_leaves_a_run_that_is_not_complete_and_can_be_resumed(tmp_path, monkeypatch):
    steps = []

    def interrupt(self):
        steps.append(self.num_timesteps)
        if len(steps) == 15:
            raise KeyboardInterrupt
        return True

    monkeypatch.setattr(DeploymentLogger, "_on_step", interrupt)
    quick = {"n_steps": 10, "batch_size": 10}
    config = configurations.configuration(
        "ppo", "solar_env/Deploy-v0", {"model": "rigid-ideal"}, 0, 1, 40, quick, residual=0.0
    )
    first, second = tmp_path / "first", tmp_path / "second"
    for folder in (first, second):
        folder.mkdir()
    with pytest.raises(KeyboardInterrupt):
        learn.train(config, first, progress=False)
    assert not runs.is_complete(first)
    learn.train(configurations.resumed_configuration(first, 10), second, first, progress=False)
    assert runs.is_complete(second)
    assert runs.algorithm("ppo").load(second / "checkpoint" / "model.zip").num_timesteps == 15 + 10


def test_only_runs_that_were_interrupted_are_discarded(tmp_path, ppo_run):
    notes, interrupted = tmp_path / "notes", tmp_path / "interrupted"
    for folder in (notes, interrupted):
        folder.mkdir()
    (notes / "mine.txt").touch()
    (interrupted / runs.CONFIG).write_bytes((ppo_run / runs.CONFIG).read_bytes())
    for folder in (notes, interrupted, ppo_run, tmp_path / "nothing"):
        runs.discard_incomplete(folder)
    assert (notes / "mine.txt").exists()
    assert (ppo_run / runs.POLICY).exists()
    assert not interrupted.exists()


@pytest.mark.parametrize("complete", [True, False])
def test_a_run_with_another_configuration_is_neither_taken_nor_removed(tmp_path, ppo_run, complete):
    folder = tmp_path / "run"
    folder.mkdir()
    for name in (runs.CONFIG, *([runs.TIMING] if complete else [])):
        (folder / name).write_bytes((ppo_run / name).read_bytes())
    wanted = replace(configurations.stored_configuration(ppo_run), seed=99)
    with pytest.raises(ValueError, match="holds a run with another configuration; choose another --out"):
        learn.train_missing({folder: wanted}, "", "cpu", Workers(1, None), progress=False)
    assert (folder / runs.CONFIG).read_bytes() == (ppo_run / runs.CONFIG).read_bytes()


def test_a_run_that_says_too_little_is_refused(tmp_path, ppo_run):
    stored = json.loads((ppo_run / runs.CONFIG).read_text())
    del stored["landings"]
    (tmp_path / runs.CONFIG).write_text(json.dumps(stored))
    with pytest.raises(ValueError, match="says nothing of landings: an older version trained it; train it anew"):
        configurations.stored_configuration(tmp_path)


def test_one_of_the_keywords_of_a_policy_leaves_the_others_as_they_are():
    def policy_kwargs(hyperparameters):
        given = configurations.configuration(
            "ppo", SUITES["paper"], {"model": "rigid-clearance"}, seed=0, hyperparameters=hyperparameters
        )
        return given.hyperparameters["policy_kwargs"]

    usual = policy_kwargs({})
    assert policy_kwargs({"policy_kwargs": {"log_std_init": -1.0}}) == {**usual, "log_std_init": -1.0}
    assert usual["log_std_init"] != -1.0


@pytest.mark.parametrize("env_id", SUITES.values(), ids=SUITES)
@pytest.mark.parametrize("residual", [None, 0.0], ids=["added", "whole"])
@pytest.mark.parametrize("algo", sorted(runs.ALGORITHMS))
def test_the_discount_reaches_over_a_whole_episode(algo, residual, env_id):
    config = configurations.configuration(algo, env_id, {"model": "rigid-clearance"}, seed=0, residual=residual)
    assert 1.0 / (1.0 - config.hyperparameters["gamma"]) >= 300.0


@pytest.mark.parametrize("algo", sorted(runs.ALGORITHMS))
@pytest.mark.parametrize("residual", [None, 0.0], ids=["added", "whole"])
def test_there_is_a_model_for_every_configuration_of_the_randomised_scenario(algo, residual):
    config = configurations.configuration(
        algo,
        SUITES["robust"],
        {"model": "rigid-clearance"},
        seed=0,
        residual=residual,
        landings=2 if residual is None else None,
    )
    venv = learn.make_training_env(config, [], None, threads=1)
    model = learn.make_model(config, venv, learn.prepare(config)[0])
    assert np.isfinite(model.predict(venv.reset(), deterministic=True)[0]).all()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--algo", "a2c"], "no algorithm 'a2c'; available: ppo, sac, td3"),
        (["--hyperparams", "n_step=3"], "ppo has no hyperparameter 'n_step'"),
        (["--timesteps", "0"], "timesteps is 0; give a positive number"),
        (["--env-id", "solar_env/Fold-v0"], "no hyperparameters for 'solar_env/Fold-v0'"),
        (["--env-kwargs", "torque_limits=0.3"], "torque_limits"),
        (["--model", "flexible"], "model 'flexible' is unknown; choose from rigid-ideal"),
        (["--elements", "0"], "elements = 0"),
        (["--seed", "-1"], "seed is -1; choose one from 0"),
        (["--landings", "0"], "landings is 0; give a positive number"),
        (["--landings", "20000"], "landings is 20000: .* a seed has 10,000 episodes; give fewer"),
        (["--hyperparams", "learning_rate=fast"], "hyperparameter learning_rate is 'fast'; give a positive number"),
        (["--hyperparams", "n_steps=0"], "hyperparameter n_steps is 0; give a positive whole number"),
        (["--hyperparams", "n_epochs=2.5"], "hyperparameter n_epochs is 2.5; give a positive whole number"),
        (["--hyperparams", "gamma=2"], "hyperparameter gamma is 2; give a number above 0, at most 1"),
        (["--hyperparams", "train_freq=0"], "ppo has no hyperparameter 'train_freq'"),
        (["--algo", "sac", "--hyperparams", "train_freq=0"], "train_freq is 0; give a positive whole number"),
        (["--algo", "td3", "--hyperparams", "exploration_noise=-0.5"], "exploration_noise is -0.5; give a positive"),
        (["--algo", "td3", "--hyperparams", "exploration_noise=much"], "exploration_noise is 'much'; give a positive"),
        (["--algo", "sac", "--hyperparams", "replay_buffer_kwargs={}"], "no hyperparameter 'replay_buffer_kwargs'"),
        (["--hyperparams", "policy_kwargs=3"], "policy_kwargs is 3; give a dictionary"),
        (["--residual", "0", "--elements", "4"], "--elements 4: the panels of rigid-clearance have none"),
        (["--residual", "0", "--landings", "7"], "landings is 7, but with residual 0 there is no law"),
        (["--residual", "0", "--law", "servo"], "law is 'servo', but with residual 0 the agent adds to none"),
        (["--law", "serve"], "residual law is 'serve'; available: brake"),
        (["--env-kwargs", "scenario=randomised"], "leave the keyword out and choose --env-id"),
        (["--env-kwargs", "max_episode_steps=20"], "max_episode_steps cuts off have no landing to judge"),
        (["--eval-episodes", "0"], "the number of episodes is 0; choose one from 1"),
        (["--jobs", "0"], "jobs = 0"),
        (["--cluster", "slurm"], "cluster 'slurm' is unknown; choose from ray"),
        (["--seeds", "0", "1", "--seed", "100000"], "seed is 100000; choose one from 0 to 99999"),
        (["--seeds", "1", "1"], "seed 1 is given 2 times; give it once"),
        (["--seeds", "1", "2", "--resume", "runs/one"], "does not go with --resume"),
    ],
)
def test_wrong_arguments_are_named_before_training(tmp_path, arguments, message):
    with pytest.raises(ValueError, match=message):
        run("--out", tmp_path / "run", *arguments)
    assert not (tmp_path / "run").exists()


def test_several_seeds_need_a_folder_to_come_back_to():
    with pytest.raises(ValueError, match="--seeds takes --out, the folder of their runs"):
        run("--seeds", 0, 1)


def test_a_folder_with_a_run_is_not_overwritten(ppo_run):
    with pytest.raises(FileExistsError, match="holds a run already"):
        run("--out", ppo_run, *SMALL["ppo"])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--algo", "sac"], "--algo sac contradicts the run to resume, which has ppo"),
        (["--model", "rigid-ideal"], "--model rigid-ideal contradicts the run to resume, which has rigid-clearance"),
        (["--seed", "1"], "--seed 1 contradicts the run to resume, which has 0"),
        (["--n-envs", "3"], "--n-envs 3 contradicts the run to resume, which has 2"),
        (["--residual", "0.5"], "--residual 0.5 contradicts the run to resume"),
        (["--law", "soft-start"], "--law soft-start contradicts the run to resume, which has servo"),
        (["--landings", "5"], "--landings 5 contradicts the run to resume, which has 4"),
        (["--hyperparams", "n_steps=200"], "--hyperparams .* contradicts the run to resume"),
    ],
)
def test_resuming_refuses_arguments_that_contradict_the_run(ppo_run, tmp_path, arguments, message):
    with pytest.raises(ValueError, match=message):
        run("--resume", ppo_run, *arguments, "--out", tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_resuming_from_something_else_than_a_run_is_refused(tmp_path):
    with pytest.raises(FileNotFoundError, match="is not a run folder"):
        run("--resume", tmp_path)
