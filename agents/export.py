"""Ship a trained policy as plain arrays and as ONNX, with a card: `python -m agents.export runs/<run> --name NAME`."""

import csv
import json
import re
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import gymnasium
import numpy as np
import torch
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.sac.policies import SACPolicy
from torch import nn

try:
    import onnxruntime
    from onnx import TensorProto, checker, helper, numpy_helper
except ImportError as missing:
    raise ImportError("exporting needs ONNX and its runtime; pip install 'solar-env[onnx]'") from missing

from agents import runs, shipped
from agents.arguments import parse_arguments, run_command
from agents.comparison.controllers import UNTRAINED
from agents.comparison.report import Row, tabulate
from agents.environments import episode_seeds, make_env
from agents.laws.baselines import BASELINES
from agents.learning.features import LIMIT, DriveFeatures
from agents.rollout import run_episode
from agents.shipped import Description, Layer, PolicyNetwork, ShippedPolicy
from solar_env.array import has_flexible_panels
from solar_env.environment.hardware import Hardware

OPSET = 17
IR_VERSION = 8  # the one that came with the opset, so that runtimes as old as the opset read the file
TOLERANCE = 1e-5  # of actions, between the network and Stable-Baselines3

ACTIVATIONS: dict[type[nn.Module], str] = {nn.ReLU: "relu", nn.Tanh: "tanh"}
ONNX_OPERATORS = {"relu": "Relu", "tanh": "Tanh"}


@dataclass
class Args:
    """Write the best policy of a run to agents/policies as arrays and as ONNX, with a card."""

    run: str | None = None
    """run folder; may be named first, without --run"""
    name: str | None = None
    """name of the policy: letters, digits, dots, dashes and underscores"""
    scores: str | None = None
    """folder of a comparison (`agents.evaluate`) in which the run, or the policy of this name, was measured, for the
    card; None: the run's own, or that of all seeds it was trained with"""


def network_of(model: BaseAlgorithm) -> PolicyNetwork:
    """The deterministic action of a Stable-Baselines3 model.

    Raises:
        ValueError: it is computed by something else than what `PolicyNetwork` has.
    """
    policy: Any = model.policy
    if isinstance(policy, ActorCriticPolicy):
        parts: list[nn.Module] = [policy.pi_features_extractor, policy.mlp_extractor.policy_net, policy.action_net]
    elif isinstance(policy, SACPolicy):
        parts = [policy.actor.features_extractor, policy.actor.latent_pi, policy.actor.mu]
    else:
        parts = [policy.actor.features_extractor, policy.actor.mu]
    leaves = [leaf for part in parts[1:] for leaf in part.modules() if not isinstance(leaf, nn.Sequential)]
    mean = max(index for index, leaf in enumerate(leaves) if isinstance(leaf, nn.Linear))
    linear, between, after = leaves[: mean + 1 : 2], leaves[1:mean:2], leaves[mean + 1 :]
    fits = (
        type(parts[0]) is DriveFeatures
        and all(type(leaf) is nn.Linear for leaf in linear)
        and all(type(leaf) in ACTIVATIONS and type(leaf) is type(between[0]) for leaf in between)
        and [type(leaf) for leaf in after] in ([], [nn.Tanh], [nn.Hardtanh])
    )
    if not fits:
        raise ValueError(
            f"the policy computes {', '.join(type(leaf).__name__ for leaf in [parts[0], *leaves])}; exported can be "
            "fully connected layers on the features of agents.learning.features with one activation, Tanh or ReLU, "
            "between them"
        )
    features = cast(DriveFeatures, parts[0])
    layers = [_layer(features.matrix, features.offset)]
    layers += [_layer(leaf.weight, leaf.bias) for leaf in cast(list[nn.Linear], linear)]
    return PolicyNetwork(
        tuple(layers),
        _layer(features.gate_matrix, features.gate_offset),
        feature_limit=LIMIT,
        activation=ACTIVATIONS[type(between[0])] if between else "tanh",
        # TD3's actor ends with the Tanh that the others leave to the distribution.
        output="tanh" if policy.squash_output else "clip",
        # SAC with state-dependent exploration keeps the mean away from where tanh is flat.
        mean_limit=next((float(leaf.max_val) for leaf in after if isinstance(leaf, nn.Hardtanh)), None),
    )


def _layer(weights: torch.Tensor, biases: torch.Tensor) -> Layer:
    return Layer(*(tensor.detach().cpu().numpy().copy() for tensor in (weights, biases)))


def difference(network: PolicyNetwork, onnx_bytes: bytes, model: BaseAlgorithm, observations: np.ndarray) -> float:
    """Greatest difference of a network's actions, and of its ONNX form's, to those of the model that it comes from.

    Args:
        network: From `network_of`.
        onnx_bytes: From `onnx_model`.
        model: What they come from.
        observations: (n, entries); looked at together and one by one.
    """
    session = onnxruntime.InferenceSession(onnx_bytes)
    found = []
    for batch in (observations, *observations[:, None]):
        expected, _ = model.predict(batch, deterministic=True)
        for actions in (network.predict(batch)[0], session.run(["action"], {"observation": batch})[0]):
            found.append(np.max(np.abs(actions - expected)))
    return float(np.max(found))


def observed(policy: ShippedPolicy, env: gymnasium.Env, seed: int) -> np.ndarray:
    """What a policy observes in a deployment (periods, entries), and as many observations drawn from all there are."""
    seen: list[np.ndarray] = []
    run_episode(env, policy, seed, lambda step: seen.append(step.observation))
    space: Any = env.observation_space
    drawn = np.random.default_rng(0).uniform(space.low, space.high, (len(seen), *space.shape))
    return np.concatenate([np.array(seen), drawn]).astype(np.float32)


def onnx_model(network: PolicyNetwork) -> Any:
    """The network as an ``onnx.ModelProto``: "observation" (n, inputs) to "action" (n, outputs), both float32."""
    nodes, constants = [], []

    def constant(name: str, value: Any, precision: type[np.floating] = np.float32) -> str:
        constants.append(numpy_helper.from_array(np.asarray(value, dtype=precision), name))
        return name

    def node(operator: str, inputs: list[str], output: str, **attributes: Any) -> str:
        nodes.append(helper.make_node(operator, inputs, [output], **attributes))
        return output

    seen = node("Cast", ["observation"], "observation_in_double_precision", to=TensorProto.DOUBLE)

    def clipped_sum(name: str, layer: Layer, low: float, high: float) -> str:
        weights, biases = (constant(f"{part}_{name}", getattr(layer, part), np.float64) for part in layer._fields)
        limits = [constant(f"least_{name}", low, np.float64), constant(f"greatest_{name}", high, np.float64)]
        return node("Clip", [node("Gemm", [seen, weights, biases], f"sum_{name}", transB=1), *limits], name)

    ungated = clipped_sum("ungated_features", network.layers[0], -network.feature_limit, network.feature_limit)
    gated = node("Mul", [ungated, clipped_sum("gates", network.gates, 0.0, 1.0)], "features_in_double_precision")
    values = node("Cast", [gated], "features", to=TensorProto.FLOAT)
    for number, layer in enumerate(network.layers[1:], start=2):
        weights, biases = constant(f"weights_{number}", layer.weights), constant(f"biases_{number}", layer.biases)
        values = node("Gemm", [values, weights, biases], f"sum_{number}", transB=1)
        if number < len(network.layers):
            values = node(ONNX_OPERATORS[network.activation], [values], f"hidden_{number}")
    if network.mean_limit is not None:
        limits = [constant("least_mean", -network.mean_limit), constant("greatest_mean", network.mean_limit)]
        values = node("Clip", [values, *limits], "limited_mean")
    if network.output == "tanh":
        node("Tanh", [values], "action")
    else:
        node("Clip", [values, constant("least_action", -1.0), constant("greatest_action", 1.0)], "action")

    graph = helper.make_graph(
        nodes,
        "policy",
        [helper.make_tensor_value_info("observation", TensorProto.FLOAT, ["n", network.inputs])],
        [helper.make_tensor_value_info("action", TensorProto.FLOAT, ["n", network.outputs])],
        constants,
    )
    model = helper.make_model(
        graph, opset_imports=[helper.make_opsetid("", OPSET)], ir_version=IR_VERSION, producer_name="solar-env"
    )
    checker.check_model(model, full_check=True)
    return model


def export(run: str | Path, folder: Path, comparison: str | Path | None = None) -> ShippedPolicy:
    """Write the best policy of a run, its ONNX form and its card to `folder`. Export only runs you trust: it unpickles.

    Args:
        run: Run folder.
        folder: Where to.
        comparison: Folder of a comparison in which the run, or a policy named as `folder` is, was measured; by default
            the run's own, or that of all the seeds that it was trained with.

    Raises:
        FileExistsError: `folder` exists.
        FileNotFoundError: there is no run, or it has no policy.
        ValueError: the training was interrupted, the policy is none that can be exported, or `comparison` has no scores
            of it.
    """
    if folder.exists():
        raise FileExistsError(f"{folder} exists; choose another --name, or remove it")
    run = Path(run)
    config = runs.read_config(run)
    if not runs.is_complete(run):
        raise ValueError(f"the training in {run} was interrupted; resume it, and export what comes of that")
    with make_env(config["env_id"], config["env_kwargs"]) as env:
        model = runs.load_model(run, env)
        network = network_of(model)
        unwrapped: Any = env.unwrapped
        description = Description(
            algorithm=config["algo"],
            feature_limit=network.feature_limit,
            activation=network.activation,
            output=network.output,
            mean_limit=network.mean_limit,
            training_steps=config["timesteps_before"] + config["timesteps"],
            env_id=config["env_id"],
            env_kwargs=config["env_kwargs"],
            observation_names=tuple(unwrapped.observation_names),
            torque_limit=unwrapped.task.torque_limit,
            deadline=unwrapped.task.deadline,
            control_period=unwrapped.task.control_period,
            postlock_window=unwrapped.task.postlock_window,
            residual=config.get("residual"),
        )
        policy = ShippedPolicy(network, description)
        onnx_bytes = onnx_model(network).SerializeToString()
        seed = episode_seeds("validation", config["seed"], 1)[0]
        found = difference(network, onnx_bytes, model, observed(policy, env, seed))
        if not found <= TOLERANCE:
            raise ValueError(f"the exported network differs from the run's policy by {found:.1e}; it is not written")
        scores = _scores(run, folder.name, Path(comparison) if comparison else None)
        card = _card(folder.name, config, policy, unwrapped, scores, found)
    folder.mkdir(parents=True)
    shipped.save(folder, policy)
    (folder / shipped.ONNX).write_bytes(onnx_bytes)
    (folder / shipped.CARD).write_text(card)
    return policy


def _card(name: str, config: dict[str, Any], policy: ShippedPolicy, env: Any, scores: str, found: float) -> str:
    """The card of a policy; `env` is the environment that it was trained on, `found` its `difference`."""
    parts = [
        f"# {name}\n\nA controller of the root hinge's motor for `{config['env_id']}`, trained by "
        f"{config['algo'].upper()} from Stable-Baselines3.",
        _training(config, policy, env),
        f"## Scores\n\n{scores}",
        _limits(policy, env),
        _use(name, policy, found),
    ]
    return "\n\n".join(parts) + "\n"


def _training(config: dict[str, Any], policy: ShippedPolicy, env: Any) -> str:
    sizes = [policy.network.inputs, *(layer.biases.size for layer in policy.network.layers)]
    hidden = f"{policy.network.activation} between the others" if len(sizes) > 3 else "the action is linear in them"
    steps = f"{config['timesteps']:,}"
    if config["resumed_from"]:
        steps += f", on top of {config['timesteps_before']:,} of `{config['resumed_from']}`"
    facts = {
        "algorithm": config["algo"],
        "environment": f"`{config['env_id']}` with `{json.dumps(config['env_kwargs'])}`",
        "model": env.model + (f", {env.elements} elements a panel" if has_flexible_panels(env.model) else ""),
        "scenario": f"{env.scenario}; drawn for every episode: {_ranges(env.randomize)}",
        "sensors and motor": _imperfections(env.hardware),
        "environment steps": steps,
        "environments together": config["n_envs"],
        "seed": config["seed"],
        "network": f"{' - '.join(map(str, sizes))}; the first layer is not learned: features of the observation, "
        f"clipped to {policy.network.feature_limit} and gated; {hidden}",
        "action": _formula(policy.description.residual),
        "versions": ", ".join(
            f"{name} {version}" for name, version in config["versions"].items() if name != "platform"
        ),
    }
    rows = "\n".join(f"| {fact} | {value} |" for fact, value in facts.items())
    return (
        f"## Training\n\n| | |\n|---|---|\n{rows}\n\nCommand:\n\n```\n{config['command']}\n```\n\n"
        f"Hyperparameters:\n\n```json\n{json.dumps(config['hyperparameters'], indent=2)}\n```\n\n"
        "Kept is the policy that did best in the validations along the way."
    )


def _ranges(ranges: Mapping[str, Any]) -> str:
    return ", ".join(f"`{name}` from {low} to {high}" for name, (low, high) in ranges.items()) or "nothing"


def _imperfections(hardware: Hardware) -> str:
    ideal = vars(Hardware())
    return ", ".join(f"`{name}` {value}" for name, value in vars(hardware).items() if value != ideal[name]) or "ideal"


def _formula(residual: Mapping[str, Any] | None) -> str:
    if residual is None:
        return "the network's"
    return (
        f"clip({residual['law']} + {residual['scale']} network, -1, 1); the law's parameters, which this policy keeps: "
        f"`{json.dumps(residual['parameters'])}`"
    )


def _scores(run: Path, name: str, comparison: Path | None) -> str:
    """What was measured of a run, as `export` says, as a table with the baselines beside it.

    Raises:
        FileNotFoundError: there is no comparison in the folder given.
        ValueError: neither the run nor a policy of this name is part of it.
    """
    if comparison is not None:
        folders = [comparison]
    else:  # training ends with a comparison of the run, or of all the seeds together, beside it
        folders = [folder for folder in (run, run.parent) if (folder / "episodes.csv").is_file()]

    def is_own(spec: str) -> bool:
        if comparison is None:
            return Path(spec).name == run.name
        return spec == name or Path(spec).resolve() == run.resolve()

    for folder in folders:
        with (folder / "episodes.csv").open() as file:
            rows = [_numbers(row) for row in csv.DictReader(file)]
        own = [row for row in rows if row["spec"] not in BASELINES and is_own(row["spec"])]
        if own:
            settings = json.loads((folder / "metrics.json").read_text())["settings"]
            tables = tabulate([row for row in rows if row["spec"] in BASELINES] + own).folded().strip()
            return f"`{own[0]['controller']}` is this policy. Measured by `{settings['command']}`.\n\n{tables}"
    if comparison is not None:
        found = ", ".join(dict.fromkeys(row["spec"] for row in rows))
        raise ValueError(f"{comparison} has no scores of {run}; it has those of {found}")
    return "None were measured."


def _numbers(row: Mapping[str, str]) -> Row:
    """A row of ``episodes.csv`` as `evaluate` returns it."""
    plain = {"True": True, "False": False}
    return {
        key: text if key in ("controller", "spec") else plain[text] if text in plain else float(text)
        for key, text in row.items()
        if text
    }


def _limits(policy: ShippedPolicy, env: Any) -> str:
    task, names = env.task, policy.description.observation_names
    lines = [
        "Trained on the model, scenario, draws, sensors and motor above, with a control period of "
        f"{task.control_period} s, a deadline of {task.deadline} s and {task.postlock_window} s after the last latch. "
        "Do not trust it with models, parameters, initial states, sensors, motors or periods on which neither training "
        "nor the scores above have tried it.",
        f"It expects these {len(names)} entries in this order, in the units of the environment: "
        f"{', '.join(f'`{name}`' for name in names)}. An action of 1 is a motor torque of {task.torque_limit} N m.",
        "It is one training seed of one algorithm, which says little about the algorithm, and chosen on simulated "
        "episodes of a planar array. It has driven no hardware, and nothing about its stability is proved.",
    ]
    return "## Limits\n\n" + "\n".join(f"* {line}" for line in lines)


def _use(name: str, policy: ShippedPolicy, found: float) -> str:
    alone = ""
    if policy.description.residual is not None:
        alone = (
            ' **The file holds the network alone**: what drives the motor is the sum with the law, see "action" above, '
            "which the NumPy form adds up."
        )
    return f"""## Use

In NumPy, without PyTorch; nothing is unpickled. Along a deployment and over random observations its network's actions,
and those of the ONNX form, differ by up to {found:.1e} from Stable-Baselines3's. With clearance even that changes
single impacts: compare means over episodes.

```python
from agents.environments import make_env
from agents.rollout import run_episode
from agents.shipped import load_shipped

policy = load_shipped("{name}")
env = make_env(policy.description.env_id, policy.description.env_kwargs)
policy.check(env)
print(run_episode(env, policy, seed=0))
```

In ONNX Runtime, from observations (n, {policy.network.inputs}) to actions (n, 1).{alone}

```python
import numpy
import onnxruntime
from agents.shipped import ONNX, SHIPPED

session = onnxruntime.InferenceSession(SHIPPED / "{name}" / ONNX)
observations = numpy.zeros((1, {policy.network.inputs}), dtype=numpy.float32)
(actions,) = session.run(["action"], {{"observation": observations}})
print(actions)
```"""


def main(argv: Sequence[str] | None = None) -> None:
    """The command line; see `Args`."""
    given = list(sys.argv[1:] if argv is None else argv)
    if given and not given[0].startswith("-"):
        given.insert(0, "--run")
    args = parse_arguments(Args, given, prog="python -m agents.export")
    if args.run is None or not re.fullmatch(r"\w[\w.-]*", args.name or ""):
        raise ValueError(f"run is {args.run!r}, name {args.name!r}; give both: agents.export runs/<run> --name NAME")
    if args.name in UNTRAINED:
        raise ValueError(f"name is {args.name!r}, which is that of a controller without learning; choose another one")
    folder = shipped.SHIPPED / str(args.name)
    export(args.run, folder, args.scores)
    print(f"written to {folder}")


if __name__ == "__main__":
    run_command(main)
