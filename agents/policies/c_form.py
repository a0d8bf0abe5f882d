"""The network of a policy as one C header: arrays and a function, for the computer of a drive."""

import re

import numpy as np

from agents.policies.network import Layer, PolicyNetwork

_ACTIVATIONS = {"relu": "{0} > 0.0f ? {0} : 0.0f", "tanh": "tanhf({0})"}


def c_header(network: PolicyNetwork, name: str, observation_names: tuple[str, ...]) -> str:
    """C99 that computes a network's action, without memory of its own beyond the stack.

    Args:
        network: of one output.
        name: of the function; what C does not take becomes an underscore.
        observation_names: of the entries, for the comment.

    Returns:
        A header with `static float NAME(const float observation[])`.
    """
    word = re.sub(r"\W", "_", name)
    features, *hidden, last = network.layers
    lines = [
        f"/* Policy {word}: action in [-1, 1] from {network.inputs} observations,",
        f"   {', '.join(observation_names)}. */",
        f"#ifndef {word.upper()}_H",
        f"#define {word.upper()}_H",
        "#include <math.h>",
        "",
        *_arrays(f"{word}_features", features, "double"),
        *_arrays(f"{word}_gates", network.gates, "double"),
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
        f"        double feature = {word}_features_biases[i], gate = {word}_gates_biases[i];",
        f"        for (k = 0; k < {network.inputs}; k++) {{",
        f"            feature += {word}_features_weights[i][k] * observation[k];",
        f"            gate += {word}_gates_weights[i][k] * observation[k];",
        "        }",
        f"        feature = fmin(fmax(feature, {-network.feature_limit!r}), {network.feature_limit!r});",
        "        values[0][i] = (float)(feature * fmin(fmax(gate, 0.0), 1.0));",
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
        limit = f"{network.mean_limit!r}f"
        mean = f"fminf(fmaxf({mean}, -{limit}), {limit})"
    action = f"tanhf({mean})" if network.output == "tanh" else f"fminf(fmaxf({mean}, -1.0f), 1.0f)"
    return "\n".join([*lines, f"    return {action};", "}", "#endif", ""])


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
