"""Baselines, their tuning, seeds, statistics and the parsing of arguments."""

import json
from dataclasses import asdict, dataclass, field, replace

import numpy as np
import pytest

from agents import baselines
from agents import tune as tune_module
from agents.arguments import parse_arguments, parse_assignments
from agents.baselines import (
    BASELINES,
    BrakeParameters,
    ConstantBrake,
    Passive,
    ServoParameters,
    VelocityProfileServo,
    load_parameters,
    make_baseline,
)
from agents.environments import DEFAULT_ENV_ID, episode_seeds, make_env, with_model, with_randomization
from agents.rollout import episode_figures, run_episode
from agents.statistics import estimate, interquartile_mean
from agents.tune import from_unit, to_unit, tune
from solar_env.array import MODELS

NAMES = (
    "theta_1",
    "theta_2",
    "rate_1",
    "rate_2",
    "latched_1",
    "latched_2",
    "motor_torque",
    "time_to_deadline",
    "time_since_latch",
)
LIMIT = 0.5
SERVO = replace(ServoParameters(), difference_damping=3.0, postlock_damping=2.0)


@pytest.fixture(scope="module")
def env():
    made = make_env()
    yield made
    made.close()


def observe(opening=0.0, rate=0.0, latched=0.0, names=NAMES):
    """Both joints `opening` of their lock angles open, at `rate` lock angles a second."""
    values = {
        "theta_1": opening,
        "theta_2": opening,
        "rate_1": rate * np.pi / 2,
        "rate_2": rate * np.pi,
        "latched_1": latched,
        "latched_2": latched,
    }
    return np.array([values.get(name, 0.3) for name in names], dtype=np.float32)


def controllers():
    return [
        Passive(NAMES, LIMIT),
        ConstantBrake(NAMES, LIMIT, BrakeParameters(torque=0.1, onset=0.5)),
        VelocityProfileServo(NAMES, LIMIT, SERVO),
    ]


@pytest.mark.parametrize("opening", [0.0, 0.5, 0.99, 1.0])
def test_servo_torque_is_zero_on_the_profile(opening):
    servo = VelocityProfileServo(NAMES, LIMIT, SERVO)
    action, _ = servo.predict(observe(opening, servo.reference_rate(opening)))
    assert action == pytest.approx(0.0, abs=1e-5)


def test_servo_drives_below_the_profile_and_brakes_above_it():
    servo = VelocityProfileServo(NAMES, LIMIT, SERVO)
    reference = servo.reference_rate(0.5)
    assert servo.predict(observe(0.5, reference - 0.01))[0] > 0.0
    assert servo.predict(observe(0.5, reference + 0.01))[0] < 0.0


def test_servo_profile_slows_down_to_the_latch_rate():
    rates = VelocityProfileServo(NAMES, LIMIT, SERVO).reference_rate(np.linspace(0.0, 1.0, 101))
    assert np.all(np.diff(rates) <= 0.0)
    assert rates[0] == pytest.approx(SERVO.cruise_rate)
    assert rates[-1] == pytest.approx(SERVO.latch_rate)


def test_servo_damps_the_rate_difference_of_the_joints():
    observation = observe(0.5, VelocityProfileServo(NAMES, LIMIT, SERVO).reference_rate(0.5))
    # The weighted opening rate keeps to the profile: joint 1 is 0.01 / s faster, joint 2 as much slower.
    observation[2] += 0.01 * np.pi / 2
    observation[3] -= 0.01 * np.pi
    servo = VelocityProfileServo(NAMES, LIMIT, replace(SERVO, joint_2_weight=0.5))
    expected = -SERVO.difference_damping * 0.02 / LIMIT
    assert servo.predict(observation)[0] == pytest.approx(expected, rel=1e-3)


def test_servo_opposes_joint_1_after_the_last_latch():
    servo = VelocityProfileServo(NAMES, LIMIT, SERVO)
    action, _ = servo.predict(observe(1.0, 0.02, latched=1.0))
    assert action == pytest.approx(-SERVO.postlock_damping * 0.02 * np.pi / 2 / LIMIT, rel=1e-5)


def test_brake_acts_between_its_onset_and_the_last_latch():
    brake = ConstantBrake(NAMES, LIMIT, BrakeParameters(torque=0.1, onset=0.5))
    openings = np.stack([observe(0.4), observe(0.6), observe(1.0, latched=1.0)])
    actions, _ = brake.predict(openings)
    np.testing.assert_allclose(actions[:, 0], [0.0, -0.1 / LIMIT, 0.0], rtol=1e-6)


def test_brake_still_acts_while_one_joint_has_yet_to_latch():
    observation = observe(1.0)
    observation[NAMES.index("latched_1")] = 1.0
    assert ConstantBrake(NAMES, LIMIT).predict(observation)[0] < 0.0


@pytest.mark.parametrize("controller", controllers(), ids=lambda c: type(c).__name__)
def test_batched_prediction_equals_the_single_ones(controller):
    rng = np.random.default_rng(0)
    batch = rng.uniform(-1.0, 1.0, (20, len(NAMES))).astype(np.float32)
    actions, _ = controller.predict(batch)
    assert actions.shape == (20, 1)
    assert actions.dtype == np.float32
    assert np.all(np.abs(actions) <= 1.0)
    np.testing.assert_array_equal(actions, [controller.predict(row)[0] for row in batch])


def test_entries_are_found_by_name_not_by_position():
    shuffled = NAMES[::-1]
    straight = VelocityProfileServo(NAMES, LIMIT, SERVO).predict(observe(0.4, 0.02))[0]
    reversed_ = VelocityProfileServo(shuffled, LIMIT, SERVO).predict(observe(0.4, 0.02, names=shuffled))[0]
    assert straight == reversed_ != 0.0


def test_servo_without_a_second_joint_is_refused_by_name():
    with pytest.raises(ValueError, match=r"VelocityProfileServo reads theta_2, rate_2"):
        VelocityProfileServo(("theta_1", "rate_1", "latched_1"), LIMIT)


def test_unknown_baseline_is_refused(env):
    with pytest.raises(ValueError, match="no baseline 'break'"):
        make_baseline("break", env)


def test_environment_without_tuned_parameters_names_the_command():
    command = r"agents\.tune --controller servo --env-id other/Env-v0 --model flexible-ideal"
    with pytest.raises(ValueError, match=command):
        load_parameters(ServoParameters, "servo", "other/Env-v0", "flexible-ideal")


def entry(torque):
    return {"parameters": {"torque": torque, "onset": 0.0}}


@pytest.fixture
def configs(tmp_path, monkeypatch):
    """A folder of configurations of its own, with a brake tuned for two of the models."""
    for module in (baselines, tune_module):
        monkeypatch.setattr(module, "CONFIGS", tmp_path)
    tuned = {"rigid-clearance": entry(0.1), "flexible-clearance": entry(0.2)}
    (tmp_path / "brake.json").write_text(json.dumps({DEFAULT_ENV_ID: tuned}))
    return tmp_path


@pytest.mark.parametrize("keywords", [{}, {"model": "rigid-clearance"}, {"elements": 1}])
def test_a_baseline_has_the_parameters_tuned_for_the_environments_own_model(configs, keywords):
    with make_env(env_kwargs=keywords) as made:
        assert make_baseline("brake", made).parameters.torque == 0.1


@pytest.mark.parametrize("elements", [1, 3])
def test_tuned_parameters_hold_for_any_number_of_elements(configs, elements):
    with make_env(env_kwargs={"model": "flexible-clearance", "elements": elements}) as made:
        assert make_baseline("brake", made).parameters.torque == 0.2


def test_a_model_that_nothing_was_tuned_for_gets_the_rigid_parameters_and_says_so(configs):
    with (
        make_env(env_kwargs={"model": "flexible-ideal"}) as made,
        pytest.warns(UserWarning, match=r"tuned for flexible-ideal; it gets those for rigid-clearance.*--model flex"),
    ):
        assert make_baseline("brake", made).parameters.torque == 0.1


def test_without_rigid_parameters_to_fall_back_on_another_model_is_refused(configs):
    (configs / "brake.json").write_text(json.dumps({DEFAULT_ENV_ID: {"flexible-clearance": entry(0.2)}}))
    with pytest.raises(ValueError, match=r"no parameters for .* with model 'flexible-ideal'"):
        load_parameters(BrakeParameters, "brake", DEFAULT_ENV_ID, "flexible-ideal")


@pytest.mark.filterwarnings("ignore:no parameters of .* have been tuned")
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("name", BASELINES)
def test_every_baseline_deploys_the_nominal_array(model, name):
    env = make_env(env_kwargs=with_model({}, model, elements=1))
    figures = run_episode(env, make_baseline(name, env), seed=0)
    assert figures["latched"]
    assert figures["latch_times_s"] <= 20.0


def test_passive_does_no_motor_work(env):
    assert run_episode(env, Passive(*signals(env)), seed=0)["motor_work_J"] == 0.0


def test_tuned_servo_latches_softer_than_the_springs_alone(env):
    passive, servo = (run_episode(env, make_baseline(name, env), seed=0) for name in ("passive", "servo"))
    assert servo["return"] > passive["return"]
    assert servo["peak_postlock_force_N"] < 0.5 * passive["peak_postlock_force_N"]


def test_the_servo_tuned_for_flexible_panels_is_better_there_than_the_one_tuned_for_rigid_ones():
    with make_env(env_kwargs=with_model({}, "flexible-clearance", 2)) as flexible:
        rigid = load_parameters(ServoParameters, "servo", DEFAULT_ENV_ID, "rigid-clearance")
        own, other = (run_episode(flexible, make_baseline("servo", flexible, p), seed=0) for p in (None, rigid))
    assert own["return"] > 0.5 * other["return"]
    assert own["peak_postlock_force_N"] < 0.5 * other["peak_postlock_force_N"]


def test_a_brake_that_stalls_the_array_misses_the_deadline_and_has_no_postlock_figures(env):
    stalled = run_episode(env, ConstantBrake(*signals(env), BrakeParameters(torque=0.5)), seed=0)
    passive = run_episode(env, Passive(*signals(env)), seed=0)
    assert not stalled["latched"]
    assert np.isnan(stalled["peak_postlock_force_N"])
    assert stalled["return"] < passive["return"]


def test_episode_figures_of_the_array_follow_from_those_of_the_joints():
    deployment = {
        "latched": True,
        "latch_times_s": [12.0, 12.5],
        "peak_postlock_force_N": [300.0, 200.0],
        "postlock_sliding_work_J": [0.01, 0.02],
        "contact_starts": [3, 4],
        "motor_work_J": -0.1,
    }
    figures = episode_figures(deployment, {"peak_impact": -3.0, "wear": -1.0})
    assert figures["return"] == -4.0
    assert figures["latch_times_s"] == 12.5
    assert figures["peak_postlock_force_N"] == 300.0
    assert figures["peak_postlock_force_2_N"] == 200.0
    assert figures["postlock_sliding_work_J"] == pytest.approx(0.03)
    assert figures["contact_starts"] == 7


def test_tuning_parameters_survive_the_way_to_the_unit_cube_and_back():
    back = from_unit(ServoParameters, to_unit(SERVO))
    assert vars(back) == pytest.approx(vars(SERVO))


def test_tuning_finds_a_minimum_within_its_budget_and_repeats_itself():
    target = np.array([0.2, 0.7, 0.5])
    calls = []

    def distances(points, seeds):
        calls.extend([tuple(seeds)] * len(points))
        return [float(np.sum((point - target) ** 2)) for point in points]

    first = tune(distances, np.full(3, 0.5), 1200, 2, seed=3, progress=False)
    assert sum(map(len, calls)) <= 1200
    np.testing.assert_allclose(first[-1], target, atol=1e-3)
    second = tune(distances, np.full(3, 0.5), 1200, 2, seed=3, progress=False)
    np.testing.assert_array_equal(first[-1], second[-1])


def test_tuning_gives_all_candidates_of_a_generation_the_same_fresh_episodes():
    calls = []

    def record(points, seeds):
        calls.extend([tuple(seeds)] * len(points))
        return [float(point[0]) for point in points]

    tune(record, np.full(2, 0.5), 60, 2, seed=0, progress=False)
    generations = list(dict.fromkeys(calls))
    assert calls == [seeds for seeds in generations for _ in range(len(calls) // len(generations))]
    assert len({seed for seeds in generations for seed in seeds}) == 2 * len(generations)


def test_tuning_refuses_a_budget_without_a_generation():
    with pytest.raises(ValueError, match="a budget of 3 episodes holds no generation"):
        tune(lambda point, seeds: 0.0, np.full(2, 0.5), 3, 2, seed=0, progress=False)


@pytest.mark.parametrize(
    ("options", "model"),
    [
        ([], "rigid-clearance"),
        (["--model", "flexible-ideal", "--elements", "1"], "flexible-ideal"),
        (["--model", "flexible-clearance", "--elements", "1"], "flexible-clearance"),
    ],
)
def test_the_command_stores_what_it_tuned_for_a_model_and_keeps_the_other_models(configs, options, model):
    before = json.loads((configs / "brake.json").read_text())[DEFAULT_ENV_ID]
    short = ["--env-kwargs", "deadline=0.3", "postlock_window=0.2", "--quiet"]
    budget = ["--episodes", "6", "--episodes-per-candidate", "1", "--validation-episodes", "1"]
    tune_module.main(["--controller", "brake", *options, *budget, *short])
    after = json.loads((configs / "brake.json").read_text())[DEFAULT_ENV_ID]
    written = after[model]
    assert written["tuning"]["training_episodes"] == 6
    assert after == {**before, model: written} != before
    with make_env(env_kwargs=with_model({}, model)) as made:
        assert asdict(make_baseline("brake", made).parameters) == written["parameters"]


def test_seeds_of_different_purposes_and_run_seeds_never_coincide():
    blocks = [
        set(episode_seeds(purpose, seed, 10_000))
        for purpose in ("training", "validation", "evaluation")
        for seed in (0, 1, 99_999)
    ]
    assert len(set.union(*blocks)) == sum(map(len, blocks))


@pytest.mark.parametrize(("seed", "count"), [(-1, 1), (100_000, 1), (0, 0), (0, 10_001)])
def test_seeds_beyond_their_block_are_refused(seed, count):
    with pytest.raises(ValueError, match="choose one from"):
        episode_seeds("training", seed, count)


def test_given_ranges_replace_the_default_ones():
    assert set(with_randomization({})["randomize"]) == {"clearance", "friction_coefficient"}
    assert with_randomization({"randomize": None})["randomize"] is None


def test_model_and_elements_join_the_environments_keywords():
    assert with_model({"torque_limit": 0.3}) == {"torque_limit": 0.3}
    assert with_model({}, "flexible-ideal", 2) == {"model": "flexible-ideal", "elements": 2}
    assert with_model({"elements": 2}, "flexible-ideal", 2) == {"model": "flexible-ideal", "elements": 2}
    with make_env(env_kwargs=with_model({}, "flexible-ideal", 2)) as made:
        assert (made.unwrapped.model, made.unwrapped.elements) == ("flexible-ideal", 2)


def test_an_automatic_model_is_kept_as_the_level_that_it_stands_for():
    keywords = {"question": "wear", "tolerance": 0.2, "torque_limit": 0.3}
    with make_env(env_kwargs={"model": "auto", **keywords}) as automatic:
        level = {"model": automatic.unwrapped.model, "elements": automatic.unwrapped.elements}
    assert with_model(keywords, "auto") == {"torque_limit": 0.3, **level}


@pytest.mark.parametrize(
    ("keywords", "option", "message"),
    [
        (
            {"model": "rigid-ideal"},
            {"model": "flexible-ideal"},
            "--model flexible-ideal contradicts --env-kwargs model",
        ),
        ({"elements": 3}, {"elements": 2}, "--elements 2 contradicts --env-kwargs elements=3"),
    ],
)
def test_options_that_contradict_the_keywords_are_refused(keywords, option, message):
    with pytest.raises(ValueError, match=message):
        with_model(keywords, **option)


def test_unknown_environment_names_those_there_are():
    with pytest.raises(ValueError, match=DEFAULT_ENV_ID):
        make_env("solar_env/Fold-v0")


def test_unknown_environment_keyword_is_named():
    with pytest.raises(ValueError, match="torque_limits"):
        make_env(DEFAULT_ENV_ID, {"torque_limits": 0.3})


def test_interquartile_mean_ignores_the_outer_quarters():
    assert interquartile_mean(np.array([-1e9, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 1e9])) == 3.5


def test_bootstrap_interval_contains_the_point_estimate_and_narrows_with_more_episodes():
    rng = np.random.default_rng(0)
    few, many = (estimate([rng.normal(size=n)]) for n in (20, 2000))
    for result in (few, many):
        assert result.lower < result.mean < result.upper
    assert many.upper - many.lower < 0.25 * (few.upper - few.lower)


def test_bootstrap_interval_covers_the_truth_about_as_often_as_it_claims():
    rng = np.random.default_rng(1)
    results = [estimate([rng.normal(size=50)], seed=i, resamples=400) for i in range(200)]
    coverage = np.mean([result.lower <= 0.0 <= result.upper for result in results])
    assert 0.88 <= coverage <= 0.99


def test_differences_between_training_runs_widen_the_interval():
    rng = np.random.default_rng(2)
    runs = [rng.normal(loc=offset, scale=0.1, size=50) for offset in (-1.0, 0.0, 1.0)]
    pooled, apart = estimate([np.concatenate(runs)]), estimate(runs)
    assert apart.mean == pooled.mean
    assert apart.upper - apart.lower > 2.0 * (pooled.upper - pooled.lower)


def test_missing_figures_are_left_out_of_the_estimate():
    result = estimate([np.array([1.0, np.nan, 1.0])])
    assert (result.mean, result.count) == (1.0, 2)
    assert np.isnan(estimate([np.array([np.nan])]).mean)


@pytest.mark.parametrize("separator", ["=", ":"])
def test_pairs_are_parsed_as_literals_and_bare_words(separator):
    pairs = ["torque_limit{}0.3", "model{}rigid-ideal", "randomize{}{{'clearance': (1e-4, 2e-4)}}"]
    assert parse_assignments([pair.format(separator) for pair in pairs]) == {
        "torque_limit": 0.3,
        "model": "rigid-ideal",
        "randomize": {"clearance": (1e-4, 2e-4)},
    }


@pytest.mark.parametrize(
    ("pair", "message"),
    [
        ("0.3", "write key=value"),
        ("torque_limit=", "write key=value"),
        ("torque_limit=__import__('os')", "neither a Python literal nor a plain word"),
    ],
)
def test_pairs_that_cannot_be_read_are_refused(pair, message):
    with pytest.raises(ValueError, match=message):
        parse_assignments([pair])


def test_a_pair_given_twice_is_refused():
    with pytest.raises(ValueError, match="'a' is given twice"):
        parse_assignments(["a=1", "a=2"])


@dataclass
class Example:
    """An example."""

    env_id: str = "x"
    """the id"""
    steps: int | None = None
    """how many"""
    quiet: bool = False
    """say nothing"""
    names: list[str] = field(default_factory=lambda: ["a"])
    """some names"""
    keywords: dict[str, object] = field(default_factory=dict)
    """some pairs"""


def test_a_documented_dataclass_is_a_command_line(capsys):
    assert parse_arguments(Example, []) == Example()
    arguments = [
        "--env-id",
        "y",
        "--steps",
        "3",
        "--quiet",
        "--names",
        "b",
        "c",
        "--keywords",
        "k=1",
        "l:two",
    ]
    assert parse_arguments(Example, arguments) == Example("y", 3, True, ["b", "c"], {"k": 1, "l": "two"})
    with pytest.raises(SystemExit):
        parse_arguments(Example, ["--help"])
    assert "how many" in capsys.readouterr().out


def test_an_unreadable_pair_ends_the_command_line_with_its_option(capsys):
    with pytest.raises(SystemExit):
        parse_arguments(Example, ["--keywords", "k"])
    assert "--keywords: cannot read 'k'" in capsys.readouterr().err


def signals(env):
    return env.unwrapped.observation_names, env.unwrapped.task.torque_limit
