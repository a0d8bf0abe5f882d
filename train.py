"""Train a controller that deploys the solar array softly, and compare it with torque laws: `solar-env train`."""

import sys

from agents.script import main

if __name__ == "__main__":
    sys.exit(main(["train", *sys.argv[1:]]))
