"""Tuned parameters, in a JSON file for each torque law, and hyperparameters of learning algorithms."""

from pathlib import Path

CONFIGS = Path(__file__).parent
