"""Train a controller that deploys the solar array softly, and compare it with the baselines: `solar-env train`."""

from agents.arguments import run_command
from agents.train import main

if __name__ == "__main__":
    run_command(main)
