"""How flexible panels are modelled: by their modes in a floating frame, or as beams of cable elements (ANCF)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

from solar_env.array.models import has_flexible_panels
from solar_env.array.names import unknown_name
from solar_env.array.parameters import ArrayParameters
from solar_env.mechanics.bodies.description import AnyBody, FlexibleBody, ModalPanel
from solar_env.mechanics.integrators.settings import ModalRadau

ANCF, MODAL = "ancf", "modal"
DEFAULT_PANELS = MODAL
DEFAULT_ELEMENTS, DEFAULT_MODES = 6, 32
# Kind of panels -> name of their count, and its default.
PANELS = {ANCF: ("elements", DEFAULT_ELEMENTS), MODAL: ("modes", DEFAULT_MODES)}
# Preset of the parameters -> kind of panels, where it is not DEFAULT_PANELS: the paper's are beams of elements.
PRESET_PANELS = {"paper": ANCF}


@dataclass(frozen=True)
class PanelModel:
    """A model of the flexible panels.

    Attributes:
        kind: one of PANELS.
        count: of what a panel consists of: beam elements of "ancf", bending modes of "modal".

    Raises:
        ValueError: on construction, if the kind is unknown or its panels refuse the count.
    """

    kind: str
    count: int

    def __post_init__(self) -> None:
        if self.kind not in PANELS:
            raise ValueError(unknown_name("panels", self.kind, PANELS))
        self.body(ArrayParameters(), "panel", {})

    @property
    def option(self) -> str:
        """Name of the count: "elements" or "modes"."""
        return PANELS[self.kind][0]

    @property
    def keywords(self) -> dict[str, Any]:
        """The choice as keywords of `simulate`, `build` and the environments."""
        return {"panels": self.kind, self.option: self.count}

    def keywords_of(self, model: str) -> dict[str, Any]:
        """The keywords where panels of a model bend, and as a record of its runs; none where they are rigid.

        Raises:
            ValueError: if the model is none of `array.MODELS`.
        """
        return self.keywords if has_flexible_panels(model) else {}

    @property
    def size(self) -> str:
        """The count in words: "32 modes"."""
        return f"{self.count} {self.option[:-1] if self.count == 1 else self.option}"

    def __str__(self) -> str:
        return f"{self.size} a panel"

    def body(self, p: ArrayParameters, name: str, motion: dict[str, Any]) -> AnyBody:
        """A panel with its motion at t = 0, keywords of the body's description."""
        section = p.panel_width * p.panel_thickness
        axial, bending = p.panel_young * section, p.panel_young * section * p.panel_thickness**2 / 12.0
        density, length = p.panel_density * section, p.panel_length
        if self.kind == ANCF:
            return FlexibleBody(name, length, self.count, density, axial, bending, p.panel_damping, **motion)
        return ModalPanel(name, length, density * length, axial, bending, p.panel_damping, modes=self.count, **motion)

    @classmethod
    def of(
        cls,
        model: str,
        panels: str | PanelModel | None = None,
        elements: int | None = None,
        modes: int | None = None,
        integrator: str | None = None,
        preset: str = "default",
    ) -> Self:
        """The model of the panels that keywords ask for; what is not named follows from what is.

        Args:
            model: one of `array.MODELS`; rigid ones do not use the panels.
            panels: one of PANELS, or a choice made already, whose count the next two may replace.
            elements, modes: of each panel; they belong to "ancf" and to "modal".
            integrator: name of a method, of which "modal-radau" goes with "modal" alone, as that with it.
            preset: parameter set of whose panels nothing else is said, see PRESET_PANELS.

        Raises:
            ValueError: if a name or a count is refused, or if they contradict each other.
        """
        defaults = {kind: count for kind, (_, count) in PANELS.items()}
        if isinstance(panels, PanelModel):
            defaults[panels.kind] = panels.count
            panels = panels.kind
        if panels is not None and panels not in PANELS:
            raise ValueError(unknown_name("panels", panels, PANELS))
        counts = {ANCF: elements, MODAL: modes}
        reasons = {} if panels is None else {panels: f"panels={panels!r}"}
        for kind, count in counts.items():
            if count is not None:
                reasons.setdefault(kind, f"{PANELS[kind][0]}={count!r}")
        if integrator is not None and has_flexible_panels(model):
            kind = MODAL if integrator == ModalRadau.name else ANCF
            reasons.setdefault(kind, f"integrator={integrator!r}")
        if len(reasons) > 1:
            raise ValueError(
                f"{reasons[ANCF]} belongs to panels of beam elements and {reasons[MODAL]} to modal panels: leave out "
                "one of them"
            )
        kind = next(iter(reasons), PRESET_PANELS.get(preset, DEFAULT_PANELS))
        count = counts[kind]
        return cls(kind, defaults[kind] if count is None else count)

    @classmethod
    def requested(
        cls,
        model: str,
        panels: str | PanelModel | None = None,
        elements: int | None = None,
        modes: int | None = None,
        integrator: str | None = None,
        preset: str = "default",
    ) -> Self:
        """As `of`, for what a user asks for: a description of flexible panels is refused where panels are rigid.

        A `PanelModel` passes: environments and the ladder have one beside every model, which rigid panels do not use.

        Raises:
            ValueError: as `of`, or if the model has rigid panels, or is none, and a name or a number is given.
        """
        chosen = cls.of(model, panels, elements, modes, integrator, preset)
        if not has_flexible_panels(model):
            named = None if isinstance(panels, PanelModel) else panels
            for name, value in {"panels": named, "elements": elements, "modes": modes}.items():
                if value is not None:
                    raise ValueError(
                        f"{name} = {value!r} describes flexible panels, and those of model = {model!r} are rigid: "
                        f"name a flexible model, or leave out {name}"
                    )
        return chosen
