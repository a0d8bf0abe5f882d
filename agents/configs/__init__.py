"""Parameters that tuning found for laws, and hyperparameters of learning algorithms: a JSON file for each."""

from pathlib import Path

CONFIGS = Path(__file__).parent
