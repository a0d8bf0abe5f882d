"""Where every equation, figure and table of the paper is found here, and what checks it."""

from dataclasses import dataclass

from solar_env.studies.paper.figures import FIGURES
from solar_env.support.markdown import markdown_table


@dataclass(frozen=True)
class Entry:
    """A place of the paper.

    Attributes:
        place: "Eq 1", "Eqs 8-15", "Fig 5", "Table 1".
        says: what stands there.
        code: file and name in it, "file.py:name".
        test: the same of a test, or of a verification case.
        remark: how it is read, or why it is not taken literally; empty where it is faithful.
    """

    place: str
    says: str
    code: str
    test: str
    remark: str = ""

    @property
    def numbers(self) -> range:
        """Numbers of the equations or figures."""
        first, _, last = self.place.split()[1].partition("-")
        return range(int(first), int(last or first) + 1)


_MECHANICS, _TESTS = "solar_env/mechanics", "tests/mechanics"
_STUDY, _STUDY_TEST = "solar_env/studies/paper", "tests/studies/paper/test_paper.py"
_REMARKS = {
    "path": "panels fold to the other side, so that it is mirrored",
    **dict.fromkeys(("small-forces", "wear"), "with the stiffness of Table 1, and beside it with that of Eq 40"),
}
INDEX: tuple[Entry, ...] = (
    Entry(
        "Table 1", "parameters of the array", "solar_env/array/parameters/parameters.py:ArrayParameters",
        "tests/array/test_parameters.py:test_the_defaults_are_the_papers_table",
    ),
    Entry(
        "Eq 1", "torsion springs", f"{_MECHANICS}/mechanism/description.py:Spring",
        f"{_TESTS}/joints/test_joint.py:test_the_spring_pulls_towards_its_preload_angle",
    ),
    Entry(
        "Eq 2", "tensions of the cable's strands", f"{_MECHANICS}/joints/cable_loop.py:strand",
        f"{_TESTS}/joints/test_cable_loop.py:test_a_cable_loop_halves_its_stiffness_when_one_strand_goes_slack",
        "never negative",
    ),
    Entry(
        "Eq 3", "forces of the strands on the bearings", f"{_MECHANICS}/joints/cable_loop.py:belt_loads",
        f"{_TESTS}/joints/test_cable_loop.py:test_the_pull_on_the_bearings_is_that_of_two_strands",
        "`cable_bearing_forces`, off: the paper's solution steps use Eq 4 alone. Across the wheels' line F1 - F2, as"
        " two strands have it, in place of the printed F1 + F2, which has no potential",
    ),
    Entry(
        "Eq 4", "torques of the closed cable loop", f"{_MECHANICS}/joints/cable_loop.py:cable_torque",
        f"{_TESTS}/joints/test_cable_loop.py:test_the_forces_of_a_belt_are_the_slope_of_its_energy",
        "along the chord of the panel; `cable_torque_ratio` 1 is the printed couple, which destroys half the energy",
    ),
    Entry(
        "Eqs 5-7", "latches: BISTOP with damping by STEP", f"{_MECHANICS}/joints/torques.py:one_sided_stop",
        f"{_TESTS}/joints/test_joint.py:test_a_latched_joint_is_held_from_both_sides_of_its_lock_angle",
        "standard BISTOP; that a joint is latched is a state and no STEP factor of its angle, which would let it go "
        "when it swings back below the lock angle",
    ),
    Entry(
        "Eqs 8-15", "rigid bodies in natural coordinates",
        f"{_MECHANICS}/bodies/natural_coordinates.py:NaturalCoordinates",
        f"{_TESTS}/bodies/test_kinds.py:test_accelerations_balance_the_applied_forces",
    ),
    Entry(
        "Eqs 16-30", "cable elements in absolute nodal coordinates",
        f"{_MECHANICS}/bodies/cable_element/element.py:CableElements",
        f"{_TESTS}/bodies/test_cable_element.py:test_a_cantilever_bends_as_eulers_and_bernoullis",
        "with f the length of r': strains f - 1 and (r' x r'') / f^2, which are right under stretch",
    ),
    Entry(
        "Eqs 31-34", "eccentricity, penetration and contact points", f"{_MECHANICS}/joints/joint.py:penetration",
        f"{_TESTS}/joints/test_joint.py:test_penetration_is_eccentricity_less_clearance_and_its_rate_the_approach",
    ),
    Entry(
        "Eq 35", "sliding speed", f"{_MECHANICS}/joints/sliding.py:contact_motion",
        f"{_TESTS}/joints/test_joint.py:"
        "test_the_places_of_contact_slide_by_the_share_of_the_depth_in_the_distance_of_the_centres",
        "`friction_sliding`: \"places\" is the equation as printed, some percent of the \"centres\"' speed; with "
        "\"material\", the default, the statements on wear come true",
    ),
    Entry(
        "Eqs 36-38", "contact forces and moments on the bodies", f"{_MECHANICS}/joints/joint.py:joint_forces",
        f"{_TESTS}/joints/test_joint.py:test_joint_forces_change_neither_linear_nor_angular_momentum",
    ),
    Entry(
        "Eq 39", "Lankarani and Nikravesh's normal force", f"{_MECHANICS}/joints/contact/lankarani_nikravesh.py:law",
        f"{_TESTS}/joints/test_contact_laws.py:test_damping_factors_are_those_of_the_named_laws",
    ),
    Entry(
        "Eq 40", "contact stiffness from radii and moduli", f"{_MECHANICS}/joints/contact/surfaces.py:Surfaces",
        "tests/array/test_parameters.py:test_the_contact_stiffness_is_given_or_follows_from_eq_40_by_joint",
        "falls with the clearance as its root, against the sentence that a larger clearance is stiffer; "
        "`contact_stiffness` None takes it, the claims are tested with it, too",
    ),
    Entry(
        "Eqs 41-42", "modified Coulomb friction", f"{_MECHANICS}/joints/friction/ramp.py:RampedCoulomb",
        f"{_TESTS}/joints/test_friction_laws.py:test_the_ramp_sets_in_at_one_speed_and_is_full_at_the_other",
    ),
    Entry(
        "Eqs 43-45", "Archard's wear", f"{_MECHANICS}/joints/wear.py:add_wear",
        f"{_TESTS}/joints/test_wear.py:test_the_volume_worn_in_a_run_is_the_coefficient_times_the_sliding_work",
    ),
    Entry(
        "Eq 46", "equations of motion with constraints", f"{_MECHANICS}/equations/system.py:accelerations",
        f"{_TESTS}/equations/test_system.py:test_the_multipliers_balance_the_equations_of_motion",
    ),
    Entry(
        "Steps of the solution", "torques and contacts of a step, then its accelerations, every 0.1 ms",
        "solar_env/array/methods.py:PAPER", "tests/array/test_deployment.py:test_integrators_by_name",
        "`integrator=\"paper\"`; by default steps adapt, and contacts and latchings are located within them",
    ),
    Entry(
        "Models 1 and 2", "distributions of the clearances", "solar_env/studies/paper/cases.py:CASES",
        "tests/studies/paper/test_paper.py:test_wear_and_impacts_are_compared_joint_by_joint",
    ),
    Entry(
        "Fig 1", "the array, its springs, its cable loop and a latch", "solar_env/array/construction.py:build",
        "tests/array/test_construction.py:test_the_folded_array_lies_in_a_stack_along_the_side_of_the_body",
        "(e) is the couple of Eq 4, a latch that of Eqs 5-7",
    ),
    Entry(
        "Figs 2-4", "sketches that go with the equations of bodies and joints, without results",
        f"{_MECHANICS}/mechanism/description.py:Mechanism",
        f"{_TESTS}/bodies/test_kinds.py:test_a_body_starts_as_described",
        "what they show is inferred from the order of the equations, not checked against a copy",
    ),
    Entry(
        "Fig 5", "four-bar linkage with a clearance joint: crank moment, rocker speed, wear",
        f"{_STUDY}/cases.py:simulate_four_bar",
        "tests/studies/paper/test_paper_four_bar.py:test_the_pin_of_figure_5_wears_as_much_as_the_forces_of_inverse_dynamics_would_wear_it",
        "lengths of the links are assumed",
    ),
    *(
        Entry(
            f"Fig {number}", figure.title, f"{_STUDY}/figures.py:FIGURES",
            f"{_STUDY_TEST}:test_the_curves_of_a_figure_are_the_columns_of_its_table", _REMARKS.get(figure.kind, ""),
        )
        for number, figure in FIGURES.items() if figure.cases
    ),
)  # fmt: skip


def as_markdown() -> str:
    """The index as a table in Markdown."""
    columns = ("in the paper", "what it says", "here", "checked by", "remark")
    rows = []
    for entry in INDEX:
        rows.append((entry.place, entry.says, f"`{entry.code}`", f"`{entry.test}`", entry.remark))
    return markdown_table(columns, rows)
