"""The card of a policy: its training, scores, limits and use, in Markdown."""

import json
from collections.abc import Mapping
from typing import Any

from agents.policies.policy import ShippedPolicy
from solar_env.environment.hardware import Hardware
from solar_env.support.markdown import markdown_table


def card(name: str, config: dict[str, Any], policy: ShippedPolicy, env: Any, scores: str, difference: float) -> str:
    """Write the card of the policy `name`, from the configuration of its run and the environment that it learned on.

    `env` is unwrapped, `scores` are in Markdown, `difference` is the greatest of the ONNX form's actions from its own.
    """
    parts = [
        f"# {name}\n\nA controller of the hinge motor for `{config['env_id']}`, trained by "
        f"{config['algo'].upper()} with the interface of Stable-Baselines3.",
        _training(config, policy, env),
        f"## Scores\n\n{scores}",
        _limits(policy, env),
        _use(name, policy, difference),
    ]
    return "\n\n".join(parts) + "\n"


def _training(config: dict[str, Any], policy: ShippedPolicy, env: Any) -> str:
    sizes = [policy.network.inputs, *(layer.biases.size for layer in policy.network.layers)]
    hidden = f"{policy.network.activation} between the others" if len(sizes) > 3 else "the action is linear in them"
    steps = f"{policy.description.training_steps:,}"
    if config["resumed_from"]:
        steps += f", those of `{config['resumed_from']}` among them"
    facts = {
        "algorithm": config["algo"],
        "environment": f"`{config['env_id']}` with `{json.dumps(config['env_kwargs'])}`",
        "model": env.model,
        "scenario": f"{env.scenario}; drawn for every episode: {_ranges(env.randomize)}",
        "sensors and motor": _imperfections(env.hardware),
        "environment steps": steps,
        "environments together": config["n_envs"],
        "seed": config["seed"],
        "network": f"{' - '.join(map(str, sizes))}; the first layer is not learned: features of the observation, "
        f"clipped to {policy.network.feature_limit}; {hidden}",
        "versions": ", ".join(
            f"{name} {version}" for name, version in config["versions"].items() if name != "platform"
        ),
    }
    table = markdown_table(("", ""), ((fact, str(value)) for fact, value in facts.items()))
    return (
        f"## Training\n\n{table}\n\nCommand:\n\n```\n{config['command']}\n```\n\n"
        f"Hyperparameters:\n\n```json\n{json.dumps(config['hyperparameters'], indent=2)}\n```\n\n"
        "Kept is the policy that did best in the validations along the way."
    )


def _ranges(ranges: Mapping[str, Any]) -> str:
    return ", ".join(f"`{name}` from {low} to {high}" for name, (low, high) in ranges.items()) or "nothing"


def _imperfections(hardware: Hardware) -> str:
    ideal = vars(Hardware())
    return ", ".join(f"`{name}` {value}" for name, value in vars(hardware).items() if value != ideal[name]) or "ideal"


def _limits(policy: ShippedPolicy, env: Any) -> str:
    task, names = env.task, policy.description.observation_names
    lines = [
        "Trained on the model, scenario, draws, sensors and motor above, with a control period of "
        f"{task.control_period} s, a deadline of {task.deadline} s and {task.postlock_window} s after the last latch. "
        "Do not trust it with models, parameters, initial states, sensors, motors or periods on which neither training "
        "nor the scores above have tried it.",
        f"It expects these {len(names)} entries in this order, in the units of the environment: "
        f"{', '.join(f'`{name}`' for name in names)}. "
        + (
            "An action sets the rate of the drive's loop."
            if task.action == "rate"
            else f"An action of 1 is a motor torque of {task.torque_limit} N m."
        ),
        "It is one training seed of one algorithm, which says little about the algorithm, and chosen on simulated "
        "episodes of a planar array. It has driven no hardware, and nothing about its stability is proved.",
    ]
    return "## Limits\n\n" + "\n".join(f"* {line}" for line in lines)


def _use(name: str, policy: ShippedPolicy, found: float) -> str:
    return f"""## Use

In NumPy, without PyTorch; nothing is unpickled. Along a deployment and over random observations the actions of the
ONNX form differ by up to {found:.1e}. With clearance even that changes single impacts: compare means over episodes.

```python
from agents.environments import make_env
from agents.policies.shipped import load_shipped
from agents.rollout import run_episode

policy = load_shipped("{name}")
env = make_env(policy.description.env_id, policy.description.env_kwargs)
policy.check(env)
print(run_episode(env, policy, seed=0))
```

In ONNX Runtime, from observations (n, {policy.network.inputs}) to actions (n, 1).

```python
import numpy
import onnxruntime
from agents.policies.shipped import ONNX, SHIPPED

session = onnxruntime.InferenceSession(SHIPPED / "{name}" / ONNX)
observations = numpy.zeros((1, {policy.network.inputs}), dtype=numpy.float32)
(actions,) = session.run(["action"], {{"observation": observations}})
print(actions)
```"""
