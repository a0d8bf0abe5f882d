"""Levels of model fidelity and their names: panels are rigid or flexible, joints are ideal or have clearance."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any, Self

from solar_env.array.parameters.rows import PanelRow
from solar_env.mechanics.bodies.description import AnyBody, Body, FlexibleBody, ModalPanel
from solar_env.support.values import unknown_name

RIGID, FLEXIBLE, IDEAL, CLEARANCE = "rigid", "flexible", "ideal", "clearance"
# Names of levels without a count: rigid panels, or flexible panels with DEFAULT_MODES modes.
MODELS = tuple(f"{panels}-{joints}" for panels in (RIGID, FLEXIBLE) for joints in (IDEAL, CLEARANCE))
MODES, ELEMENTS = "modes", "elements"
DEFAULT_MODES = 32
_WORD = re.compile(r"(?P<name>[^:]+)(: *(?P<count>\d+) (?P<unit>mode|element)s?)?")


@dataclass(frozen=True)
class ModelLevel:
    """A level of model fidelity, like "rigid-clearance", "flexible-ideal:6 elements" or "flexible-clearance:8 modes".

    Attributes:
        panels: "rigid" or "flexible".
        joints: "ideal" or "clearance".
        unit: discretisation of flexible panels: "modes" for bending modes in a floating frame, "elements" for cable
            elements of the absolute nodal coordinate formulation; "" for rigid panels.
        count: number of modes or elements in each panel; 0 for rigid panels.

    Raises:
        ValueError: on construction, if panels of this kind cannot have this number of modes or elements.
    """

    panels: str
    joints: str
    unit: str = ""
    count: int = 0

    def __post_init__(self) -> None:
        if not self.flexible and (self.unit or self.count):
            raise ValueError(f"model '{self.name}' has rigid panels, which take no count: leave out '{self.size}'")
        self.body(PanelRow(1.0, 0.1, 1.0, 1.0, 1.0, 0.0), "panel", {})

    @classmethod
    def of(cls, word: str | Self) -> Self:
        """Return the level that `word` names, or `word` if it is a level; an unknown name raises a ValueError."""
        if isinstance(word, cls):
            return word
        found = _WORD.fullmatch(word) if isinstance(word, str) else None
        name = found["name"] if found else word
        if found is None or name not in MODELS:
            raise ValueError(
                f"{unknown_name('model', name, MODELS)} (a fineness may follow flexible panels, as in "
                "'flexible-clearance:8 modes' or 'flexible-ideal:6 elements')"
            )
        panels, joints = name.split("-")
        if found["count"] is not None:
            return cls(panels, joints, f"{found['unit']}s", int(found["count"]))
        return cls(panels, joints, MODES, DEFAULT_MODES) if panels == FLEXIBLE else cls(panels, joints)

    @property
    def name(self) -> str:
        """Name of the level without the number of modes or elements, one of MODELS."""
        return f"{self.panels}-{self.joints}"

    @property
    def flexible(self) -> bool:
        """True if the panels bend."""
        return self.panels == FLEXIBLE

    @property
    def clearance(self) -> bool:
        """True if the joints have clearance."""
        return self.joints == CLEARANCE

    @property
    def modal(self) -> bool:
        """True if bending modes in a floating frame describe the panels."""
        return self.unit == MODES

    @property
    def size(self) -> str:
        """Number of modes or elements of each panel in words, such as "32 modes"; or "rigid"."""
        return f"{self.count} {self.unit[:-1] if self.count == 1 else self.unit}" if self.unit else RIGID

    def __str__(self) -> str:
        """Return the shortest name of the level, which leaves out the default number of modes."""
        return self.name if self.size in (RIGID, f"{DEFAULT_MODES} {MODES}") else f"{self.name}:{self.size}"

    def body(self, panel: PanelRow, name: str, motion: dict[str, Any]) -> AnyBody:
        """Return the body that models a panel at this level; `motion`: position, angle, velocity, spin at t = 0."""
        if not self.flexible:
            return Body(name, panel.mass, panel.inertia, panel.length, (panel.centroid, 0.0), **motion)
        elastic = panel.axial_stiffness, panel.bending_stiffness, panel.damping
        if self.modal and panel.masses:
            raise ValueError(
                f"panel_masses do not go with panels of modes: choose model = '{self.name}:6 elements', or rigid panels"
            )
        if self.modal:
            return ModalPanel(name, panel.length, panel.mass, *elastic, modes=self.count, **motion)
        return FlexibleBody(name, panel.length, self.count, panel.linear_density, *elastic, panel.masses, **motion)
