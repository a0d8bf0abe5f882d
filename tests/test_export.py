"""Trained policies as plain arrays and as ONNX: that they act as the run's own, and that nothing is unpickled."""

import json
import pickle
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import onnxruntime
import pytest
from stable_baselines3 import PPO, SAC, TD3
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor, FlattenExtractor
from torch import nn

from agents import baselines, configurations, export, learn, runs, shipped
from agents.baselines import make_baseline, read_parameters
from agents.environments import DEFAULT_ENV_ID, make_env
from agents.evaluate import evaluate
from agents.features import LIMIT, DriveFeatures, whole_motion
from agents.report import write_comparison
from agents.rollout import run_episode
from agents.shipped import Layer, PolicyNetwork, load_shipped

# The law that a residual is added to has not been tuned for the model that is quickest to train on.
pytestmark = pytest.mark.filterwarnings("ignore:no parameters of .* have been tuned")

COMMAND = "python train.py --seed 7"
QUICK = {"model": "rigid-ideal", "control_period": 0.5, "postlock_window": 2.0, "observation": "drive"}
ON_POLICY = {"n_steps": 50, "batch_size": 50}
OFF_POLICY = {"learning_starts": 60, "buffer_size": 500, "batch_size": 16}
RESIDUAL = {"law": "servo", "parameters": {}, "tuning_episodes": 0, "scale": 0.2}
# Name -> algorithm, hyperparameters, scale of the residual.
TRAINED = {
    "ppo": ("ppo", ON_POLICY, 0.0),
    "sac": ("sac", OFF_POLICY, 0.0),
    "td3": ("td3", OFF_POLICY, 0.0),
    "residual": ("ppo", ON_POLICY, 0.3),
}


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """Name -> run, and folder of what was exported of it; the residual has scores."""
    folder = tmp_path_factory.mktemp("export")
    made = {}
    for name, (algo, hyperparameters, residual) in TRAINED.items():
        config = configurations.configuration(algo, DEFAULT_ENV_ID, QUICK, 7, 1, 100, hyperparameters, residual, 2)
        run = runs.new_run_folder(folder / "runs" / name, config.env_id, algo, config.seed)
        learn.train(config, run, command=COMMAND, progress=False, threads=1)
        if name == "residual":
            rows = evaluate(["passive", f"ppo={run}"], 2, 7, config.env_id, config.env_kwargs, progress=False)
            write_comparison(run, rows, {"command": COMMAND}, {})
        made[name] = run, folder / "policies" / name
        export.export(*made[name])
    return made


@pytest.fixture
def own(finished, tmp_path):
    """A copy of an exported policy that a test may spoil."""
    for path in finished["ppo"][1].iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    return tmp_path


def spoil_description(folder, **changes):
    content = json.loads((folder / shipped.DESCRIPTION).read_text())
    (folder / shipped.DESCRIPTION).write_text(json.dumps({**content, **changes}))


def spoil_arrays(folder, **changes):
    with np.load(folder / shipped.ARRAYS) as file:
        arrays = dict(file)
    np.savez(folder / shipped.ARRAYS, **{**arrays, **changes})


def random_observations(count, seed=1):
    """Every other one is of an almost still, latched array, which clips no feature; the others clip most of them."""
    observations = np.random.default_rng(seed).uniform(-2.0, 2.0, (count, 9))
    observations[::2, :2] = 1.0 + observations[::2, :2] / 210.0
    observations[::2, 2:4] /= 21.0
    observations[::2, 6] /= 3.1
    return observations.astype(np.float32)


@pytest.mark.parametrize("name", TRAINED)
def test_a_shipped_network_acts_as_stable_baselines3_in_numpy_and_in_onnx(finished, name):
    run, folder = finished[name]
    observations = random_observations(500)
    network, env = load_shipped(folder).network, make_env(env_kwargs=QUICK)
    expected, _ = runs.load_model(run, env).predict(observations, deterministic=True)
    actions, _ = network.predict(observations)
    assert (actions.shape, actions.dtype) == ((500, 1), np.float32)
    np.testing.assert_allclose(actions, expected, rtol=0.0, atol=1e-6)
    one, _ = network.predict(observations[3])
    assert one.shape == (1,)
    np.testing.assert_allclose(one, expected[3], rtol=0.0, atol=1e-6)
    session = onnxruntime.InferenceSession(folder / shipped.ONNX)
    for batch in (observations, observations[:1]):
        (found,) = session.run(["action"], {"observation": batch})
        np.testing.assert_allclose(found, network.predict(batch)[0], rtol=0.0, atol=1e-6)


def untrained(cls, **keywords):
    env = make_env(env_kwargs={"model": "rigid-ideal", "observation": "drive"})
    features = {
        "features_extractor_class": DriveFeatures,
        "features_extractor_kwargs": {"features": whole_motion(env.unwrapped.observation_names)},
    }
    kwargs = {"net_arch": [32, 16], **features, **keywords.pop("policy_kwargs", {})}
    return cls("MlpPolicy", env, policy_kwargs=kwargs, seed=3, device="cpu", **keywords)


def last_linear(model):
    policy = model.policy
    output = policy.action_net if isinstance(model, PPO) else policy.actor.mu
    return [module for module in output.modules() if isinstance(module, nn.Linear)][-1]


KINDS = [
    (PPO, {}, "tanh", "clip", None),
    (PPO, {"use_sde": True}, "tanh", "clip", None),
    (PPO, {"use_sde": True, "policy_kwargs": {"squash_output": True}}, "tanh", "tanh", None),
    (PPO, {"policy_kwargs": {"activation_fn": nn.ReLU, "net_arch": []}}, "tanh", "clip", None),
    (SAC, {}, "relu", "tanh", None),
    (SAC, {"use_sde": True}, "relu", "tanh", 2.0),
    (SAC, {"use_sde": True, "policy_kwargs": {"clip_mean": 1.2}}, "relu", "tanh", 1.2),
    (TD3, {}, "relu", "tanh", None),
    (TD3, {"policy_kwargs": {"activation_fn": nn.Tanh}}, "tanh", "tanh", None),
]


@pytest.mark.parametrize(("cls", "keywords", "activation", "output", "mean_limit"), KINDS)
def test_means_beyond_the_limits_are_handled_as_the_algorithm_does(cls, keywords, activation, output, mean_limit):
    model = untrained(cls, **keywords)
    last = last_linear(model)
    last.weight.data *= 2.0 / last.weight.data.norm()
    last.bias.data += 1.2
    network = export.network_of(model)
    assert (network.activation, network.output) == (activation, output)
    assert network.mean_limit == mean_limit
    observations = random_observations(2000)
    expected, _ = model.predict(observations, deterministic=True)
    greatest = 1.0 if output == "clip" else np.tanh(mean_limit or 9.0)
    assert expected.max() == pytest.approx(greatest, abs=0.05)
    assert expected.min() < 0.9 * greatest
    actions, _ = network.predict(observations)
    np.testing.assert_allclose(actions, expected, rtol=0.0, atol=1e-6)
    session = onnxruntime.InferenceSession(export.onnx_model(network).SerializeToString())
    np.testing.assert_allclose(session.run(None, {"observation": observations})[0], actions, rtol=0.0, atol=1e-6)


class Doubling(BaseFeaturesExtractor):
    def __init__(self, observation_space):
        super().__init__(observation_space, observation_space.shape[0])

    def forward(self, observations):
        return 2.0 * observations


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"activation_fn": nn.ELU}, "computes DriveFeatures, Linear, ELU, Linear, ELU, Linear; exported can be"),
        ({"features_extractor_class": Doubling, "features_extractor_kwargs": {}}, "computes Doubling, Linear"),
        (
            {"features_extractor_class": FlattenExtractor, "features_extractor_kwargs": {}},
            "computes FlattenExtractor, Linear.*exported can be .* layers on the features of agents.features",
        ),
    ],
)
def test_policies_of_another_kind_are_refused(keywords, message):
    with pytest.raises(ValueError, match=message):
        export.network_of(untrained(PPO, policy_kwargs=keywords))


def test_the_first_layer_and_its_limit_are_the_features_of_the_observation(finished):
    policy = load_shipped(finished["ppo"][1])
    features = whole_motion(policy.description.observation_names)
    for array, expected in zip((*policy.network.layers[0], *policy.network.gates), features, strict=True):
        np.testing.assert_array_equal(array, expected)
    assert policy.network.feature_limit == policy.description.feature_limit == LIMIT


def test_features_are_clipped_and_gated_and_not_activated():
    features = Layer(np.array([[3.0, 0.0]]), np.zeros(1))
    gates = Layer(np.array([[0.0, 2.0]]), np.full(1, -0.5))
    output = Layer(np.full((1, 1), 0.5, np.float32), np.zeros(1, np.float32))
    network = PolicyNetwork((features, output), gates, feature_limit=1.5, activation="relu", output="clip")
    observations = np.array(
        [[-2.0, 1.0], [-0.2, 1.0], [0.2, 1.0], [2.0, 1.0], [2.0, 0.5], [2.0, 0.2]], dtype=np.float32
    )
    expected = np.array([[-0.75], [-0.3], [0.3], [0.75], [0.375], [0.0]])
    np.testing.assert_allclose(network.predict(observations)[0], expected, atol=1e-6)
    session = onnxruntime.InferenceSession(export.onnx_model(network).SerializeToString())
    np.testing.assert_allclose(session.run(None, {"observation": observations})[0], expected, atol=1e-6)


@pytest.mark.parametrize("name", TRAINED)
def test_a_shipped_policy_deploys_the_array_as_the_run_does(finished, name):
    run, folder = finished[name]
    policy = load_shipped(folder)
    env = make_env(policy.description.env_id, policy.description.env_kwargs)
    policy.check(env)
    expected, figures = (run_episode(env, controller, seed=5) for controller in (runs.load_policy(run, env), policy))
    assert figures == pytest.approx(expected, rel=1e-3, abs=1e-6, nan_ok=True)


def test_a_residual_is_added_to_its_law_with_the_parameters_that_it_was_shipped_with(finished, monkeypatch):
    policy = load_shipped(finished["residual"][1])
    residual = policy.description.residual
    assert residual == runs.read_config(finished["residual"][0])["residual"]
    env = make_env(policy.description.env_id, policy.description.env_kwargs)
    servo = make_baseline("servo", env, read_parameters("servo", residual["parameters"]))
    observations = random_observations(100)
    expected = servo.predict(observations)[0] + residual["scale"] * policy.network.predict(observations)[0]
    np.testing.assert_allclose(policy.predict(observations)[0], np.clip(expected, -1.0, 1.0), rtol=0.0, atol=1e-6)
    monkeypatch.setattr(baselines, "CONFIGS", Path("retuned"))
    again = load_shipped(finished["residual"][1])
    np.testing.assert_array_equal(again.predict(observations)[0], policy.predict(observations)[0])


def test_loading_needs_neither_pickle_nor_learning_libraries(finished, run_python):
    program = """
import pickle, sys
pickle.load = pickle.loads = pickle.Unpickler = None
from agents.shipped import load_shipped
print(load_shipped(sys.argv[1]).predict([0.0] * 9)[0].shape)
print([name for name in ("torch", "stable_baselines3", "onnx") if name in sys.modules])
"""
    assert run_python(program, str(finished["sac"][1])).splitlines() == ["(1,)", "[]"]


class Payload:
    """What runs when it is unpickled."""

    def __reduce__(self):
        return pytest.fail, ("unpickled",)


def test_pickled_content_is_refused_and_not_run(own):
    objects = np.array([Payload()], dtype=object)
    spoil_arrays(own, weights_1=objects)
    with pytest.raises(ValueError, match=r"policy\.npz cannot be read as plain arrays, and is not unpickled: Object"):
        load_shipped(own)
    (own / shipped.ARRAYS).write_bytes(pickle.dumps(Payload()))
    with pytest.raises(ValueError, match=r"policy\.npz cannot be read as plain arrays, and is not unpickled"):
        load_shipped(own)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"weights_3": np.zeros((64, 63), np.float32)}, r"layer 3: weights have shape \(64, 63\), but layer 2 has 64"),
        ({"weights_2": np.zeros((64, 9), np.float32)}, r"layer 2: weights have shape \(64, 9\), but layer 1 has 11"),
        ({"biases_3": np.zeros(63, np.float32)}, r"layer 3: biases have shape \(63,\), but weights have .*\(64, 64\)"),
        (
            {f"weights_{key}": np.zeros((11, 8)) for key in (1, "gates")},
            r"layer 1: weights have shape \(11, 8\); expected 9 inputs.*theta",
        ),
        ({"weights_1": np.zeros((11, 9), np.float32)}, "layer 1: weights are of type float32; expected float64"),
        ({"weights_2": np.zeros((64, 11))}, "layer 2: weights are of type float64; expected float32"),
        ({"biases_1": np.full(11, np.nan)}, "layer 1: biases hold nan"),
        ({"biases_4": np.zeros((1, 1), np.float32)}, r"layer 4: biases have shape \(1, 1\); expected 1 dimension"),
        ({"weights_gates": np.zeros((11, 8))}, r"gates: weights have shape .* expected those of layer 1"),
        ({"biases_gates": np.full(11, np.inf)}, "gates: biases hold inf"),
        ({"weights_9": np.zeros((1, 1), np.float32)}, r"policy\.npz holds \['biases_1', .*expected weights_1"),
    ],
)
def test_arrays_that_do_not_fit_are_named(own, changes, message):
    spoil_arrays(own, **changes)
    with pytest.raises(ValueError, match=f"{own}.*{message}"):
        load_shipped(own)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"format": 1}, r"policy\.json has format 1; this version reads format 3"),
        ({"colour": "red"}, r"policy\.json has the keys .*'colour'.*; expected"),
        ({"activation": "elu"}, "activation is 'elu'; choose from relu, tanh"),
        ({"output": "none"}, "output is 'none'; choose from clip, tanh"),
        ({"feature_limit": 0.0}, "feature_limit is 0.0; give a positive finite number"),
        ({"feature_limit": "two"}, "'<' not supported"),
        ({"mean_limit": -1.0}, "mean_limit is -1.0; give a positive"),
        ({"mean_limit": "two"}, "'<' not supported"),
        (
            {"residual": {"law": "servo"}},
            r"residual has the keys \['law'\]; expected law, parameters, tuning_episodes and",
        ),
        ({"residual": {**RESIDUAL, "law": "serve"}}, "residual law is 'serve'; available: brake"),
        (
            {"residual": RESIDUAL},
            r"the keys are \[\]; expected \['cruise_rate'",
        ),
        (
            {"residual": {**RESIDUAL, "law": "brake", "parameters": {"torque": 0.1, "onset": 0.0}, "scale": 2}},
            "residual = 2; give a share",
        ),
    ],
)
def test_descriptions_that_do_not_fit_are_named(own, changes, message):
    spoil_description(own, **changes)
    with pytest.raises(ValueError, match=f"{own}.*{message}"):
        load_shipped(own)


def test_an_unknown_policy_is_answered_with_those_that_there_are(finished, monkeypatch):
    monkeypatch.setattr(shipped, "SHIPPED", finished["ppo"][1].parent)
    with pytest.raises(FileNotFoundError, match=r"no shipped policy 'nobody'.*available: ppo, residual, sac, td3"):
        load_shipped("nobody")
    assert load_shipped("td3").description.algorithm == "td3"


def test_observations_and_environments_of_another_kind_are_refused(finished):
    policy = load_shipped(finished["ppo"][1])
    with pytest.raises(ValueError, match=r"the observation has shape \(3, 8\); expected \(9,\) or \(n, 9\)"):
        policy.predict(np.zeros((3, 8)))
    for keywords, message in [
        ({"torque_limit": 0.3}, r"torque_limit is 0\.3; the policy was trained with 0\.5"),
        ({"control_period": 0.1}, r"control_period is 0\.1; the policy was trained with 0\.5"),
        ({"postlock_window": 5.0}, r"postlock_window is 5\.0; the policy was trained with 2\.0"),
        ({"observation": "history"}, r"names is .*theta_1_1_ago"),
    ]:
        with make_env(env_kwargs={**QUICK, **keywords}) as env, pytest.raises(ValueError, match=message):
            policy.check(env)


FEATURES = Layer(np.zeros((3, 2)), np.zeros(3))
OUTPUT = Layer(np.zeros((1, 3), np.float32), np.zeros(1, np.float32))
GATES = Layer(np.zeros((3, 2)), np.ones(3))
EMPTY = Layer(np.zeros((0, 2)), np.zeros(0))


@pytest.mark.parametrize(
    ("layers", "message"),
    [
        ((), "there are 0 layers; a policy network needs features and an output"),
        ((FEATURES,), "there are 1 layers; a policy network needs features and an output"),
        ((EMPTY, OUTPUT), r"layer 1: weights have shape \(0, 2\)"),
    ],
)
def test_empty_networks_are_refused(layers, message):
    with pytest.raises(ValueError, match=message):
        PolicyNetwork(layers, GATES, 2.0, "relu", "tanh")


@pytest.mark.parametrize("limit", [0.0, -2.0, np.inf, np.nan])
def test_features_need_a_positive_finite_limit(limit):
    with pytest.raises(ValueError, match=f"feature_limit is {limit}; give a positive finite number"):
        PolicyNetwork((FEATURES, OUTPUT), GATES, limit, "relu", "tanh")


def test_the_card_tells_how_the_policy_came_about_and_its_snippets_run(finished, monkeypatch, capsys):
    folder = finished["residual"][1]
    monkeypatch.setattr(shipped, "SHIPPED", folder.parent)
    card = (folder / shipped.CARD).read_text()
    assert COMMAND in card
    assert "| seed | 7 |" in card
    assert '"n_steps": 50' in card
    features = len(load_shipped(finished["residual"][1]).network.layers[0].biases)
    assert f"| network | 9 - {features} - 1; the first layer is not learned" in card
    assert "the action is linear in them" in card
    assert "model | rigid-ideal" in card
    assert "`ppo` is this policy" in card
    assert "| passive | " in card
    assert "The file holds the network alone" in card
    snippets = re.findall(r"```python\n(.*?)```", card, re.DOTALL)
    assert len(snippets) == 2
    for snippet in snippets:
        exec(snippet, {})
    assert "'return'" in capsys.readouterr().out


def test_the_card_of_one_of_several_seeds_has_its_scores_alone_and_without_any_it_says_so(finished, tmp_path):
    assert "None were measured." in (finished["ppo"][1] / shipped.CARD).read_text()
    measured, folder = finished["residual"]
    run = tmp_path / "residual"
    run.mkdir()
    for name in (runs.CONFIG, runs.POLICY, runs.TIMING):
        (run / name).write_bytes((measured / name).read_bytes())
    (tmp_path / "metrics.json").write_bytes((measured / "metrics.json").read_bytes())
    rows = (measured / "episodes.csv").read_text()
    other = "".join(line.replace(str(measured), "another") for line in rows.splitlines(True) if line.startswith("ppo,"))
    (tmp_path / "episodes.csv").write_text(rows + other)
    export.export(run, tmp_path / "shipped")
    with pytest.raises(ValueError, match=r"has no scores of .*ppo; it has those of passive"):
        export.export(finished["ppo"][0], tmp_path / "other", comparison=tmp_path)
    assert not (tmp_path / "other").exists()
    (tmp_path / "episodes.csv").write_text(rows.replace(str(measured), "of-this-name"))
    export.export(measured, tmp_path / "of-this-name", comparison=tmp_path)
    cards = ((tmp_path / name / shipped.CARD).read_text() for name in ("shipped", "of-this-name"))
    alone = re.findall(r"^\| ppo .*", (folder / shipped.CARD).read_text(), re.MULTILINE)
    assert alone
    assert all(re.findall(r"^\| ppo .*", card, re.MULTILINE) == alone for card in cards)


def test_the_policy_of_an_interrupted_training_is_not_shipped(finished, tmp_path):
    run = tmp_path / "run"
    run.mkdir()
    for name in (runs.CONFIG, runs.POLICY):
        (run / name).write_bytes((finished["ppo"][0] / name).read_bytes())
    with pytest.raises(ValueError, match="was interrupted; resume it, and export what comes of that"):
        export.export(run, tmp_path / "shipped")


def test_the_command_writes_below_the_shipped_policies_and_overwrites_nothing(finished, tmp_path, monkeypatch):
    monkeypatch.setattr(shipped, "SHIPPED", tmp_path / "policies")
    run = str(finished["td3"][0])
    export.main([run, "--name", "soft"])
    names = {path.name for path in (tmp_path / "policies" / "soft").iterdir()}
    assert names == {"policy.npz", "policy.json", "policy.onnx", "card.md"}
    assert shipped.available() == ["soft"]
    with pytest.raises(FileExistsError, match="soft exists; choose another --name"):
        export.main(["--run", run, "--name", "soft"])
    with pytest.raises(ValueError, match="name is 'servo', which is that of a controller without learning"):
        export.main([run, "--name", "servo"])
    for arguments in ([run], [run, "--name", "../soft"], ["--name", "soft"]):
        with pytest.raises(ValueError, match=r"give both: agents\.export runs/<run> --name NAME"):
            export.main(arguments)


@pytest.mark.parametrize("package", ["onnx", "onnxruntime"])
def test_without_onnx_it_says_what_to_install(package, run_python):
    program = f"""
import sys
sys.modules["{package}"] = None
try:
    import agents.export
except ImportError as error:
    print(error)
"""
    assert run_python(program).strip() == "exporting needs ONNX and its runtime; pip install 'solar-env[onnx]'"


def test_the_parity_that_the_card_tells_is_that_of_the_onnx_form_too(finished):
    run, folder = finished["ppo"]
    policy, env = load_shipped(folder), make_env(env_kwargs=QUICK)
    model, observations = runs.load_model(run, env), export.observed(policy, env, seed=3)
    written = (folder / shipped.ONNX).read_bytes()
    assert export.difference(policy.network, written, model, observations) < export.TOLERANCE
    scaled = Layer(1.001 * policy.network.layers[0].weights, policy.network.layers[0].biases)
    other = export.onnx_model(replace(policy.network, layers=(scaled, *policy.network.layers[1:])))
    assert export.difference(policy.network, other.SerializeToString(), model, observations) > export.TOLERANCE


@pytest.mark.parametrize("name", TRAINED)
def test_a_shipped_policy_acts_alone_as_among_others_to_the_last_bit(finished, name):
    policy = load_shipped(finished[name][1])
    observations = random_observations(100)
    together = policy.predict(observations)[0]
    np.testing.assert_array_equal(together, [policy.predict(observation)[0] for observation in observations])
    np.testing.assert_array_equal(together[7:9], policy.predict(observations[7:9])[0])


def test_a_network_that_acts_otherwise_than_the_run_is_not_written(finished, tmp_path, monkeypatch):
    right = export.network_of
    monkeypatch.setattr(export, "network_of", lambda model: replace(right(model), activation="relu"))
    with pytest.raises(ValueError, match=r"differs from the run's policy by .*; it is not written"):
        export.export(finished["ppo"][0], tmp_path / "policy")
    assert not (tmp_path / "policy").exists()
