"""The command line: `python -m solar_env COMMAND --help`."""

import argparse
import importlib
import sys
import warnings

COMMANDS = {
    "simulate": ("solar_env.commands.simulate", "simulate one deployment"),
    "parameters": ("solar_env.commands.parameters", "print a complete file of parameters, each explained"),
    "loads": ("solar_env.commands.loads", "how hard hinges and hub are hit, and how sure that is"),
    "verify": ("solar_env.commands.verify", "run the cases with known answers"),
    "chart": ("solar_env.commands.chart", "measure speed against accuracy and draw it"),
    "stability": ("solar_env.commands.stability", "map where methods fail, and check that the library says so"),
    "paper": ("solar_env.commands.paper", "draw the figures of the paper and judge what it says"),
    "design": ("solar_env.commands.design", "map peak force and wear over clearances and stiffnesses"),
    "ground-test": ("solar_env.commands.ground_test", "repeat deployments with the worn clearance fed back"),
    "ladder": ("solar_env.commands.ladder", "measure which model level answers which question, and at what cost"),
    "bench": ("solar_env.commands.bench", "measure environment steps per second, and what they cost"),
    "figures": ("solar_env.commands.figures", "draw the pictures of the pages"),
    "warmup": ("solar_env.commands.warmup", "compile all kernels, which later runs load from the cache"),
}


def parse(arguments: list[str]) -> argparse.Namespace:
    """Read a command line; wrong input ends the process with argparse's message and status 2."""
    parser = argparse.ArgumentParser(prog="python -m solar_env", description=__doc__)
    subparsers = parser.add_subparsers(dest="command", required=True)
    for name, (module, summary) in COMMANDS.items():
        subparser = subparsers.add_parser(name, help=summary, description=summary)
        # Only the module of the command that runs is loaded.
        if name in arguments[:1]:
            importlib.import_module(module).add_arguments(subparser)
    return parser.parse_args(arguments)


def main(arguments: list[str] | None = None) -> int:
    """Run a command; returns the exit status: 0 done, 1 a verification or map failed, 2 wrong input or a failed run."""
    args = parse(sys.argv[1:] if arguments is None else arguments)
    from solar_env.mechanics.running.errors import SimulationError

    usual = warnings.formatwarning
    warnings.formatwarning = lambda message, *_, **__: f"warning: {message}\n"  # without the line of code
    try:
        return int(importlib.import_module(COMMANDS[args.command][0]).run_command(args))
    except (ValueError, SimulationError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    finally:
        warnings.formatwarning = usual


if __name__ == "__main__":
    sys.exit(main())
