"""The card of a policy: its training, scores, limits and use, in Markdown."""

import json
from typing import Any

from agents.environments import Keywords
from agents.policies.shipped import ShippedPolicy
from solar_env.environment.hardware import Hardware


def card(name: str, config: Keywords, policy: ShippedPolicy, env: Any, scores: str, difference: float) -> str:
    """Write the card of the policy `name`, from the configuration of its run and the environment that it learned on.

    `env` is unwrapped, `scores` are in Markdown, `difference` is the greatest between the forms' actions.
    """
    network, names, task = policy.network, policy.description.observation_names, env.task
    sizes = " - ".join(map(str, [network.inputs, *(layer.biases.size for layer in network.layers)]))
    between = f", {network.activation} between its layers" if len(network.layers) > 1 else ", linear"
    ranges = [f"`{key}` from {low} to {high}" for key, (low, high) in env.randomize.items()]
    ideal = vars(Hardware())
    hardware = [f"`{key}` {value}" for key, value in vars(env.hardware).items() if value != ideal[key]]
    action = (
        "An action sets the rate of the drive's loop."
        if task.action == "rate"
        else f"An action of 1 is a motor torque of {task.torque_limit} N m."
    )
    return f"""# {name}

A controller of the hinge motor for `{config["env_id"]}`, trained by {config["algo"].upper()} with the interface of
Stable-Baselines3.

## Training

Trained on the model {env.model} in the scenario {env.scenario}. Drawn for every episode:
{", ".join(ranges) or "nothing"}.
Sensors and motor: {", ".join(hardware) or "ideal"}. Network: {sizes}{between}; observations are clipped to
{network.observation_limit}. The configuration:

```json
{json.dumps(config, indent=2)}
```

Kept is the policy that did best in the validations along the way.

## Scores

{scores}

## Limits

* Trained on the model, scenario, draws, sensors and motor above, with a control period of {task.control_period} s, a
  deadline of {task.deadline} s and {task.settling_window} s after the last latch. Do not trust it with models,
  parameters, initial states, sensors, motors or periods on which neither training nor the scores above have tried it.
* It expects these {len(names)} entries in this order, in the units of the environment:
  {", ".join(f"`{entry}`" for entry in names)}. {action}
* It is one training seed of one algorithm, which says little about the algorithm, and chosen on simulated episodes of a
  planar array. It has driven no hardware, and nothing about its stability is proved.

## Use

In NumPy, without PyTorch; nothing is unpickled. Over random observations the actions of the ONNX form
differ by up to {difference:.1e}. With clearance even that changes single impacts: compare means over
episodes.

```python
from agents.environments import make_env
from agents.policies.shipped import load_shipped
from agents.rollout import run_episode

policy = load_shipped("{name}")
env = make_env(policy.description.env_id, policy.description.env_kwargs)
policy.check(env)
print(run_episode(env, policy, seed=0))
```

In ONNX Runtime, from observations (n, {network.inputs}) to actions (n, 1).

```python
import numpy
import onnxruntime
from agents.policies.shipped import ONNX, SHIPPED

session = onnxruntime.InferenceSession(SHIPPED / "{name}" / ONNX)
observations = numpy.zeros((1, {network.inputs}), dtype=numpy.float32)
(actions,) = session.run(["action"], {{"observation": observations}})
print(actions)
```
"""
