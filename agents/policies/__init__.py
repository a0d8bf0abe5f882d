"""Trained policies: run folders that come with the package, networks as plain arrays, and their ONNX form.

To add a policy, copy `config.json` and `best_model.zip` of its run to `agents/policies/NAME`, with a `card.md`.
"""
