"""Trained policies: the network as plain arrays, its ONNX and C forms, its card, and the files.

Imports `agents.torque_laws` and the environment's settings; `network` and `shipped` run without PyTorch.
To add a policy: `solar-env export RUN --out agents/policies/NAME` writes its folder.
"""
