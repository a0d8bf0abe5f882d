"""The network of a policy as one C header: arrays and a function, for the computer of a drive."""

import re
from collections.abc import Mapping, Sequence

import numpy as np

from agents.policies.network import Layer, PolicyNetwork
from agents.policies.policy import Description
from solar_env.environment.hardware import Hardware
from solar_env.environment.task.features import FEATURES, FORMULA_WORDS, Feature
from solar_env.environment.task.observations import LOCK_ANGLE, OBSERVABLES, Observable
from solar_env.environment.task.task import SLOWEST, STEEPNESS

_ACTIVATIONS = {"relu": "{0} > 0.0f ? {0} : 0.0f", "tanh": "tanhf({0})"}


def c_header(network: PolicyNetwork, name: str, comment: Sequence[str]) -> str:
    """C99 that computes a network's action, without memory of its own beyond the stack.

    Args:
        network: of one output.
        name: of the function; what C does not take becomes an underscore.
        comment: lines that say what goes in and what comes out, see `interface_comment`.

    Returns:
        A header with `static float NAME(const float observation[])`.
    """
    word = re.sub(r"\W", "_", name)
    features, *hidden, last = network.layers
    lines = [
        f"/* Policy {word}: one action from {network.inputs} observations.",
        *(_in_a_comment(line) for line in comment),
        "*/",
        f"#ifndef {word.upper()}_H",
        f"#define {word.upper()}_H",
        "#include <math.h>",
        "",
        *_arrays(f"{word}_features", features, "double"),
    ]
    for number, layer in enumerate((*hidden, last), start=1):
        lines += _arrays(f"{word}_layer_{number}", layer, "float")
    widest = max(layer.biases.size for layer in network.layers)
    lines += [
        f"static float {word}(const float observation[{network.inputs}])",
        "{",
        f"    float values[2][{widest}];",
        "    int i, k;",
        f"    for (i = 0; i < {features.biases.size}; i++) {{",
        f"        double feature = {word}_features_biases[i];",
        f"        for (k = 0; k < {network.inputs}; k++)",
        f"            feature += {word}_features_weights[i][k] * observation[k];",
        f"        values[0][i] = (float)fmin(fmax(feature, {-network.feature_limit!r}), {network.feature_limit!r});",
        "    }",
    ]
    before, hidden_value = features.biases.size, _ACTIVATIONS[network.activation].format("sum")
    for number, layer in enumerate((*hidden, last), start=1):
        source, target = (number - 1) % 2, number % 2
        lines += [
            f"    for (i = 0; i < {layer.biases.size}; i++) {{",
            f"        float sum = {word}_layer_{number}_biases[i];",
            f"        for (k = 0; k < {before}; k++)",
            f"            sum += {word}_layer_{number}_weights[i][k] * values[{source}][k];",
            f"        values[{target}][i] = {'sum' if layer is last else hidden_value};",
            "    }",
        ]
        before = layer.biases.size
    mean = f"values[{len(network.layers[1:]) % 2}][0]"
    if network.mean_limit is not None:
        limit = f"{float(network.mean_limit)!r}f"
        mean = f"fminf(fmaxf({mean}, -{limit}), {limit})"
    action = f"tanhf({mean})" if network.output == "tanh" else f"fminf(fmaxf({mean}, -1.0f), 1.0f)"
    return "\n".join([*lines, f"    return {action};", "}", "#endif", ""])


def _in_a_comment(line: str) -> str:
    """A line within a comment of C, which it cannot end: what a policy says of itself comes from whoever made it."""
    plain = "".join(character if character.isprintable() else " " for character in line)
    # C joins a line that ends in a backslash, or in its trigraph, with the next one before it looks for comments.
    return f"   {plain}".replace("\\", "/").replace("??/", "?? /").replace("*/", "* /").rstrip()


def interface_comment(description: Description, drive: Hardware) -> list[str]:
    """Lines that say what a policy observes, what its action is, and how often it is asked.

    Args:
        description: of the policy.
        drive: on which it was trained.
    """
    period, limit = description.control_period, description.torque_limit
    hinge = description.signals.driven_joint + 1
    lines = [
        f"Trained by {description.algorithm} on {description.env_id}.",
        f"Call it every {period:g} s, and hold the action until the next call.",
        "",
        "Observations, in order. Clip each to its bounds before the call; the function does not.",
    ]
    table: tuple[Observable | Feature, ...] = (*OBSERVABLES, *FEATURES)
    rows = {row.name: row for row in table}
    width = max(map(len, description.observation_names))
    some_formula = False
    for number, name in enumerate(description.observation_names):
        stem, joint, age = _split(name, rows)
        row = rows.get(stem)
        if row is None:
            lines.append(f"{number:3d}  {name}")
            continue
        when = f", as it was {age} periods ago" if age else ""
        at = f" (joint {joint})" if joint else ""
        unit = _unit(row.unit, description)
        lines.append(
            f"{number:3d}  {name:{width}}  [{row.low:.6g}, {row.high:.6g}]  {row.meaning}{at}{when}; unit: {unit}"
        )
        if isinstance(row, Feature):
            formula = row.formula.replace("_j", f"_{joint}") if joint else row.formula
            lines.append(f"{'':5}{'':{width}}  = {formula}")
            some_formula = True
    if some_formula:
        lines += ["", "where", *(f"  {word}: {meaning}" for word, meaning in FORMULA_WORDS.items())]
        lines.append(
            f"and the lock angle is pi/2 of joint 1, pi of the others; the deadline {description.deadline:g} s."
        )
    lines += ["", "Action, clipped to [-1, 1] by the function; positive opens:"]
    if description.signals.action == "rate":
        lines += [
            f"the setpoint {SLOWEST:g} sinh({STEEPNESS:g} action) rad/s of the rate of hinge {hinge}.",
            f"The drive's loop asks for {drive.rate_loop_gain:g} N m s/rad times (setpoint - rate), at most {limit:g}",
            f"N m either way, {drive.rate_loop_frequency:g} times a second, and passes it to the motor through a",
            f"low-pass filter with the time constant {drive.rate_loop_lag:g} s.",
        ]
    else:
        lines.append(f"the torque of the motor on hinge {hinge}, in units of {limit:g} N m.")
    return lines


def _split(name: str, rows: Mapping[str, object]) -> tuple[str, int, int]:
    """Name in the table, joint counted from 1 or 0 for none, and age in control periods, of an entry."""
    past = re.fullmatch(r"(\w+?)_(\d+)_ago", name)
    stem, age = (past[1], int(past[2])) if past else (name, 0)
    own = re.fullmatch(r"(\w+)_(\d+)", stem)
    if stem not in rows and own:
        return own[1], int(own[2]), age
    return stem, 0, age


def _unit(unit: str, description: Description) -> str:
    """A unit of the table in SI units."""
    value = {"torque_limit": "N m", "deadline": "s", "postlock_window": "s"}.get(unit)
    if value is None:
        return {LOCK_ANGLE: "lock angle (pi/2 of joint 1, pi of the others)", "-": "none"}.get(unit, unit)
    return f"{getattr(description, unit):g} {value}"


def _arrays(name: str, layer: Layer, kind: str) -> list[str]:
    """Definitions of weights and biases."""
    rows = ",\n    ".join("{" + _numbers(row, kind) + "}" for row in layer.weights)
    outputs, inputs = layer.weights.shape
    return [
        f"static const {kind} {name}_weights[{outputs}][{inputs}] = {{\n    {rows}}};",
        f"static const {kind} {name}_biases[{outputs}] = {{{_numbers(layer.biases, kind)}}};",
        "",
    ]


def _numbers(values: np.ndarray, kind: str) -> str:
    """Literals with all digits of their precision."""
    form, end = ("{:.17e}", "") if kind == "double" else ("{:.9e}", "f")
    return ", ".join(form.format(value) + end for value in values.tolist())
