"""The network of a policy as one C header: arrays and a function, for the computer of a drive."""

import re
from collections.abc import Sequence

import numpy as np

from agents.policies.network import PolicyNetwork
from agents.policies.shipped import Description
from solar_env.environment.hardware import Hardware
from solar_env.environment.task.drive import SLOWEST, STEEPNESS
from solar_env.environment.task.features import FEATURES, FORMULA_WORDS, Feature
from solar_env.environment.task.observations import OBSERVABLES, Observable

_ACTIVATIONS = {"relu": "fmaxf(sum, 0.0f)", "tanh": "tanhf(sum)"}


def c_header(network: PolicyNetwork, name: str, comment: Sequence[str]) -> str:
    """C99 that computes a network's action, without memory beyond the stack.

    Args:
        network: of one output.
        name: of the function; what C does not take becomes an underscore.
        comment: lines that say what goes in and what comes out, see `interface_comment`.

    Returns:
        A header with `static float NAME(const float observation[])`.
    """
    word = re.sub(r"\W", "_", name)
    lines = [
        f"/* Policy {word}: one action from {network.inputs} observations.",
        *(_in_a_comment(line) for line in comment),
        "*/",
        f"#ifndef {word.upper()}_H",
        f"#define {word.upper()}_H",
        "#include <math.h>",
        "",
    ]
    for number, (weights, biases) in enumerate(network.layers, start=1):
        rows = ",\n    ".join("{" + _numbers(row) + "}" for row in weights)
        outputs, inputs = weights.shape
        lines += [
            f"static const float {word}_weights_{number}[{outputs}][{inputs}] = {{\n    {rows}}};",
            f"static const float {word}_biases_{number}[{outputs}] = {{{_numbers(biases)}}};",
            "",
        ]
    widest = max(network.inputs, *(layer.biases.size for layer in network.layers))
    lines += [
        f"static float {word}(const float observation[{network.inputs}])",
        "{",
        f"    float values[2][{widest}];",
        "    int i, k;",
        f"    for (i = 0; i < {network.inputs}; i++)",
        f"        values[0][i] = {_clipped('observation[i]', network.observation_limit)};",
    ]
    for number, layer in enumerate(network.layers, start=1):
        source, target = (number - 1) % 2, number % 2
        outputs, inputs = layer.weights.shape
        value = "sum" if layer is network.layers[-1] else _ACTIVATIONS[network.activation]
        lines += [
            f"    for (i = 0; i < {outputs}; i++) {{",
            f"        float sum = {word}_biases_{number}[i];",
            f"        for (k = 0; k < {inputs}; k++)",
            f"            sum += {word}_weights_{number}[i][k] * values[{source}][k];",
            f"        values[{target}][i] = {value};",
            "    }",
        ]
    mean = f"values[{len(network.layers) % 2}][0]"
    if network.mean_limit is not None:
        mean = _clipped(mean, network.mean_limit)
    action = f"tanhf({mean})" if network.output == "tanh" else _clipped(mean, 1.0)
    return "\n".join([*lines, f"    return {action};", "}", "#endif", ""])


def _clipped(expression: str, limit: float) -> str:
    """An expression of C between minus and plus a limit."""
    return f"fminf(fmaxf({expression}, -{float(limit)!r}f), {float(limit)!r}f)"


def _numbers(values: np.ndarray) -> str:
    """Literals with all digits of single precision."""
    return ", ".join(f"{value:.9e}f" for value in values.tolist())


def _in_a_comment(line: str) -> str:
    """A line within a comment of C, which it cannot end: what a policy says of itself comes from whoever made it."""
    plain = "".join(character if character.isprintable() else " " for character in line)
    # C joins a line that ends in a backslash, or in its trigraph, with the next one before it looks for comments.
    return f"   {plain}".replace("\\", "/").replace("??/", "?? /").replace("*/", "* /").rstrip()


def interface_comment(description: Description, hardware: Hardware) -> list[str]:
    """Say in lines what a policy observes, what its action is, and how often it is asked.

    Args:
        description: of the policy.
        hardware: on which it was trained.
    """
    limit = description.torque_limit
    lines = [
        f"Trained by {description.algorithm} on {description.env_id}.",
        f"Call it every {description.control_period:g} s, and hold the action until the next call.",
        "",
        "Observations, in order. Clip each to its bounds before the call; the function does not.",
    ]
    table: tuple[Observable | Feature, ...] = (*OBSERVABLES, *FEATURES)
    rows = {row.name: row for row in table}
    some_formula = False
    for number, name in enumerate(description.observation_names):
        parts = re.fullmatch(r"(?P<stem>\w+?)(_(?P<joint>\d))?(_(?P<age>\d+)_ago)?", name)
        stem, joint, age = parts.group("stem", "joint", "age") if parts and name not in rows else (name, None, None)
        row = rows.get(stem)
        if row is None:
            lines.append(f"{number:3d}  {name}")
            continue
        where = f" (joint {joint})" if joint else ""
        when = f", as it was {age} periods ago" if age else ""
        bounds = f"[{row.low:.6g}, {row.high:.6g}]"
        lines.append(f"{number:3d}  {name}  {bounds}  {row.meaning}{where}{when}; unit: {row.unit}")
        if isinstance(row, Feature):
            lines.append(f"       = {row.formula.replace('_j', f'_{joint}') if joint else row.formula}")
            some_formula = True
    lines += ["", "where"]
    if some_formula:
        lines += [f"  {word}: {meaning}" for word, meaning in FORMULA_WORDS.items()]
    lines += [
        f"the unit torque_limit is {limit:g} N m, deadline {description.deadline:g} s, settling_window "
        f"{description.settling_window:g} s, and the lock angle pi/2 of joint 1, pi of the others.",
        "",
        "Action, clipped to [-1, 1] by the function; positive opens:",
    ]
    hinge = description.signals.driven_joint + 1
    if description.signals.action == "rate":
        lines += [
            f"the setpoint {SLOWEST:g} sinh({STEEPNESS:g} action) rad/s of the rate of hinge {hinge}.",
            f"The drive's loop asks for {hardware.rate_loop_gain:g} N m s/rad times (setpoint - rate), at most",
            f"{limit:g} N m either way, {hardware.rate_loop_frequency:g} times a second, and passes it to the motor",
            f"through a low-pass filter with the time constant {hardware.rate_loop_lag:g} s.",
        ]
    else:
        lines.append(f"the torque of the motor on hinge {hinge}, in units of {limit:g} N m.")
    return lines
