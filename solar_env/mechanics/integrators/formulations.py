"""Table of the formulations of the equations of motion, by the class of their model arrays."""

from solar_env.mechanics.arrays.model import Model
from solar_env.mechanics.equations.absolute import AbsoluteCoordinates
from solar_env.mechanics.equations.formulation import Formulation
from solar_env.mechanics.modal.arrays import ModalModel
from solar_env.mechanics.modal.formulation import FloatingFrames
from solar_env.mechanics.numerics.by_type import chosen_by_type

ABSOLUTE, FLOATING = AbsoluteCoordinates(), FloatingFrames()
FORMULATIONS: dict[type, Formulation] = {Model: ABSOLUTE, ModalModel: FLOATING}

# Kernels call view_joint_of(model)(model, state, j).
view_joint_of = chosen_by_type(FORMULATIONS, lambda formulation: formulation.view_joint)
