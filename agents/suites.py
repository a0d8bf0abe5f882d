"""The comparisons that the README shows: which controllers, on which scenario."""

from dataclasses import dataclass
from typing import Any

from agents import shipped
from agents.baselines import TUNABLE

# Both are judged on the finest model that is in everyday use.
MODEL: dict[str, Any] = {"model": "flexible-clearance", "elements": 6}


@dataclass(frozen=True)
class Suite:
    """A comparison.

    Attributes:
        env_id: The scenario.
    """

    env_id: str

    def controllers(self) -> list[str]:
        """The passive deployment, all tuned baselines, and the shipped policies that were trained on the scenario."""
        names = shipped.available()
        trained = [name for name in names if shipped.load_shipped(name).description.env_id == self.env_id]
        return ["passive", *TUNABLE, *trained]


SUITES = {
    "paper": Suite("solar_env/Deploy-v0"),
    "robust": Suite("solar_env/DeployRandomised-v0"),
}
