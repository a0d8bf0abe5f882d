"""Trained policies: the network as plain arrays, its ONNX and C forms, its card, and the files.

Imports `agents.torque_laws`; `network` and `policy` run without PyTorch.
`shipped` loads the folders. To add a policy: `solar-env export RUN --out agents/policies/NAME` writes its folder.
"""
