"""The network of a policy as an ONNX model, and the parity of the two."""

from typing import Any

import numpy as np
import onnxruntime
from onnx import TensorProto, checker, helper, numpy_helper

from agents.policies.network import PolicyNetwork

OPSET = 17
IR_VERSION = 8  # the one that came with the opset, so that runtimes as old as the opset read the file
ONNX_OPERATORS = {"relu": "Relu", "tanh": "Tanh"}


def onnx_model(network: PolicyNetwork) -> Any:
    """Build the network as an `onnx.ModelProto`: "observation" (n, inputs) to "action" (n, outputs), both float32."""
    nodes, constants = [], []

    def constant(name: str, value: Any, precision: type[np.floating] = np.float32) -> str:
        constants.append(numpy_helper.from_array(np.asarray(value, dtype=precision), name))
        return name

    def node(operator: str, inputs: list[str], output: str, **attributes: Any) -> str:
        nodes.append(helper.make_node(operator, inputs, [output], **attributes))
        return output

    seen = node("Cast", ["observation"], "observation_in_double_precision", to=TensorProto.DOUBLE)

    first = network.layers[0]
    weights, biases = (constant(f"{part}_1", getattr(first, part), np.float64) for part in first._fields)
    limits = [
        constant("least_feature", -network.feature_limit, np.float64),
        constant("greatest_feature", network.feature_limit, np.float64),
    ]
    total = node("Gemm", [seen, weights, biases], "sum_1", transB=1)
    features = node("Clip", [total, *limits], "features_in_double_precision")
    values = node("Cast", [features], "features", to=TensorProto.FLOAT)
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


def difference(network: PolicyNetwork, onnx_bytes: bytes, observations: np.ndarray) -> float:
    """Return the greatest difference of the actions of the ONNX form of a network from its own.

    The observations (n, entries) are tried together and one by one.
    """
    session = onnxruntime.InferenceSession(onnx_bytes)
    batches = (observations, *observations[:, None])
    found = [session.run(["action"], {"observation": batch})[0] - network.act(batch) for batch in batches]
    return max(float(np.max(np.abs(each))) for each in found)
