"""Commands of `solar-env`: each module has a documented dataclass `Args` and `run_command(args) -> int`.

Commands are thin: they read options, call a study or a simulation, and print. A ValueError, SimulationError or OSError
from `run_command` ends the process with the error's message and status 2. Commands may import everything in the
package, but `run_command` itself imports modules that need the compiler, so that `--help` is quick. A new command is a
module here and an entry of `[project.entry-points."solar_env.commands"]` in pyproject.toml; the first sentence of its
`Args` appears in the help. The studies of `solar-env study` are in `studies`.
"""
