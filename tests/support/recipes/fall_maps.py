"""Map of a falling bob: the speed that it gains."""

from solar_env.mechanics.integrators.settings import RungeKutta
from solar_env.mechanics.mechanism.textbook import STANDARD_GRAVITY, pendulum
from solar_env.mechanics.running.simulation import Simulation
from solar_env.studies.stability.maps import Axis, Finding, Kind, StabilityMap


def measure_fall(panel: str, rtol: float, time: float) -> Finding:
    """Speed over g t; wrong if it is off by a thousandth."""
    simulation = Simulation(pendulum(), RungeKutta(rtol=rtol))
    simulation.advance(time)
    ratio = -float(simulation.state.v[3]) / (STANDARD_GRAVITY * time)
    return Finding(Kind.FINE if abs(ratio - 1.0) < 1e-3 else Kind.WRONG, ratio)


RTOL, TIME = Axis("rtol", "rtol", (1e-6,), (1e-6, 1e-3)), Axis("time", "time [s]", (0.001, 0.01), (0.001, 0.003, 0.01))
BOB = StabilityMap("fall", "Fall", RTOL, TIME, ("runge-kutta",), "speed over g t", "Nothing to do.", measure_fall)
