"""Conversion of a policy's network to an ONNX model."""

import numpy as np
from onnx import ModelProto, NodeProto, TensorProto, checker, helper, numpy_helper

from agents.policies.network import PolicyNetwork

OPSET = 17
IR_VERSION = 8  # version that came with the opset, so that runtimes as old as the opset read the file
ONNX_OPERATORS = {"relu": "Relu", "tanh": "Tanh"}


def onnx_model(network: PolicyNetwork) -> ModelProto:
    """Build the `onnx.ModelProto` that maps "observation" (n, inputs) to "action" (n, outputs), both float32."""
    nodes: list[NodeProto] = []
    constants: list[TensorProto] = []

    def node(operator: str, values: str, output: str, *parameters: object, **attributes: object) -> str:
        names = [f"{output}_{number}" for number in range(len(parameters))]
        arrays = [np.asarray(parameter, dtype=np.float32) for parameter in parameters]
        constants.extend(map(numpy_helper.from_array, arrays, names))
        nodes.append(helper.make_node(operator, [values, *names], [output], **attributes))
        return output

    def clip(values: str, output: str, limit: float) -> str:
        return node("Clip", values, output, -limit, limit)

    values = "observation"
    for number, layer in enumerate(network.layers, start=1):
        values = node("Gemm", values, f"sum_{number}", *layer, transB=1)
        if number < len(network.layers):
            values = node(ONNX_OPERATORS[network.activation], values, f"hidden_{number}")
    if network.mean_limit is not None:
        values = clip(values, "limited_mean", network.mean_limit)
    if network.output == "tanh":
        node("Tanh", values, "action")
    else:
        clip(values, "action", 1.0)
    graph = helper.make_graph(
        nodes,
        "policy",
        [helper.make_tensor_value_info("observation", TensorProto.FLOAT, ["n", network.inputs])],
        [helper.make_tensor_value_info("action", TensorProto.FLOAT, ["n", network.outputs])],
        constants,
    )
    opsets = [helper.make_opsetid("", OPSET)]
    model = helper.make_model(graph, opset_imports=opsets, ir_version=IR_VERSION, producer_name="solar-env")
    checker.check_model(model, full_check=True)
    return model
