"""Style of all plots: style sheet, and fixed looks of joints, integrators, model levels, controllers and outcomes.

A look is colour, marker and line style, as arguments of Matplotlib's `plot`. Colours come from M. Okabe and K. Ito,
Color Universal Design (2008): colour-blind readers can distinguish them. A few more colours are added.
"""

from collections.abc import Mapping, Sequence
from typing import Any

Look = dict[str, Any]

BLUE, VERMILLION, GREEN, PURPLE = "#0072b2", "#d55e00", "#009e73", "#cc79a7"
SKY, ORANGE, OLIVE, GREY = "#56b4e9", "#e69f00", "#8a7f00", "#555555"
BROWN, VIOLET, CRIMSON = "#7b4f2a", "#6a3d9a", "#b80058"
COLOURS = (BLUE, VERMILLION, GREEN, PURPLE, SKY, ORANGE, OLIVE, GREY)  # joint i has colour i modulo 8
FAINT, STEEL, SAND = "#c8ced6", "#7c8896", "#ddcc77"
FORCE_DECADES = (-2, 3)  # powers of ten at the ends of the force scale [N], in frames and in comparisons
STYLE: Any = {  # not dict[str, Any]: Matplotlib's type lists the allowed keys
    "font.size": 8,
    "axes.labelsize": 8,
    "axes.titlesize": 8.5,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "figure.titlesize": 10,
    "figure.titleweight": "bold",
    "grid.color": "#e6e9ed",
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.0,
    "legend.frameon": False,
    "legend.fontsize": 7.5,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "text.usetex": False,  # in case the user's own style asks for LaTeX, which may be missing
    "svg.hashsalt": "solar_env",  # without this salt, names inside an SVG differ from run to run
}


def _look(color: str, marker: str, linestyle: str = "-") -> Look:
    return {"color": color, "marker": marker, "linestyle": linestyle}


# Lines are solid for the integration methods of this project, dotted for Exudyn's.
METHOD_LOOKS: Mapping[str, Look] = {
    "default settings": _look("black", "h"),
    "runge-kutta": _look(BLUE, "o"),
    "rosenbrock": _look(VERMILLION, "s"),
    "modal-radau": _look(CRIMSON, "d"),
    "generalized-alpha": _look(GREEN, "D"),
    "paper's scheme": _look(PURPLE, "v"),
    "Exudyn generalized-alpha": _look(ORANGE, "*", ":"),
    "Exudyn explicit": _look(BROWN, "<", ":"),
}
# Finer model levels are darker: beam elements blue, modes red, tighter tolerances violet; rigid panels are black.
LEVEL_LOOKS: Mapping[str, Look] = {
    "rigid": _look("black", "s"),
    "1 element": _look("#b7d4ea", "o"),
    "2 elements": _look("#8fbcdf", "^"),
    "4 elements": _look("#5f9fd0", "v"),
    "6 elements": _look("#3480bd", "D"),
    "12 elements": _look("#1b6cae", "P"),
    "24 elements": _look("#0d4f94", "X"),
    "48 elements": _look("#08306b", "<"),
    "4 modes": _look("#fdcc8a", "h"),
    "8 modes": _look("#fca55d", "p"),
    "16 modes": _look("#f4793b", "d"),
    "24 modes": _look("#e35f2a", "*"),
    "32 modes": _look("#c9360f", "4"),
    "48 modes": _look("#8f2300", "H"),
    "32 modes, rtol / 2": _look("#c9a0dc", "8"),
    "32 modes, rtol / 4": _look("#a06cc0", "1"),
    "48 modes, rtol / 10": _look(VIOLET, "2"),
    # Looks of model levels that only shortened studies use.
    "8 modes, rtol / 2": _look(PURPLE, "3"),
}
CONTROLLER_LOOKS: Mapping[str, Look] = {
    "passive": _look(GREY, "o", "--"),
    "damper": _look(GREEN, "^"),
    "servo": _look(BLUE, "s"),
    "soft-start": _look(ORANGE, ">"),
    "pd": _look(CRIMSON, "d"),
    "receding-horizon": _look("black", "*"),
    "ppo": _look(VERMILLION, "P"),
    "sac": _look(VIOLET, "X"),
    "cma-es": _look("#2ab7a9", "H"),
    "ars": _look("#9aa300", "1"),
    "tqc": _look("#8c564b", "p"),
    "refined": _look("#d6278a", "D"),
}
# Colours of outcomes in stability maps, in the order of a legend, after P. Tol, "Colour schemes", SRON technical
# note 2021 (muted). Colour-blind readers can distinguish these colours.
OUTCOME_COLOURS: Mapping[str, str] = {
    "fine": "#f2f4f6",
    "stiff": "#88ccee",
    "creeps": SAND,
    "over-damped": "#6699cc",
    "wrong value": "#44aa99",
    "spikes": "#e0a0b4",
    "growing": "#ee8866",
    "does not end": "#999933",
    "Newton failure": "#aa4499",
    "blow-up": "#882255",
    "refused": "#9a9fa5",
}
# Looks of controllers that are not in `CONTROLLER_LOOKS`, such as training runs.
_OTHERS = (_look("#ff5fa2", "h"), _look("#6b8e23", "2"), _look("#a05fff", "8"), _look("#3d3d8f", "4"))


def look_of(name: str, looks: Mapping[str, Look]) -> Look:
    """Return the look (colour, marker and line style) of `name` in `looks`, a table of this module.

    Raises:
        ValueError: the table has no such name.
    """
    if name not in looks:
        raise ValueError(f"{name!r} has no colour and marker: add a row for it to its table in {__name__}")
    return looks[name]


def controller_looks(names: Sequence[str]) -> dict[str, Look]:
    """Return the looks (colour, marker and line style) of the controllers in one plot, by name.

    A controller has its look from `CONTROLLER_LOOKS`. A controller named after another one ("cma-es-rigid") has that
    look, and a search around another controller ("receding-horizon:servo") has the look of the search. If that look is
    taken, or if no row of the table fits the name, the controller has the next of a few spare looks.
    """
    looks = {name: CONTROLLER_LOOKS[name] for name in names if name in CONTROLLER_LOOKS}
    taken, spare = list(looks.values()), list(_OTHERS)
    for name in names:
        if name not in looks:
            owners = (row for row in CONTROLLER_LOOKS if name.startswith((f"{row}-", f"{row}:")))
            of_owner = CONTROLLER_LOOKS.get(next(owners, ""))
            look = of_owner if of_owner is not None and of_owner not in taken else spare[0]
            spare = spare[1:] + spare[:1] if look is spare[0] else spare
            taken.append(look)
            looks[name] = look
    return {name: looks[name] for name in names}
