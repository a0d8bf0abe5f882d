"""The four models of the array: panels rigid or flexible, joints ideal or with clearance."""

RIGID, FLEXIBLE, IDEAL, CLEARANCE = "rigid", "flexible", "ideal", "clearance"
MODELS = tuple(f"{panels}-{joints}" for panels in (RIGID, FLEXIBLE) for joints in (IDEAL, CLEARANCE))


def check_model(model: str) -> str:
    """Return `model` if it is one of MODELS.

    Raises:
        ValueError: otherwise.
    """
    if model not in MODELS:
        raise ValueError(f"model {model!r} is unknown; choose from {', '.join(MODELS)}")
    return model


def has_flexible_panels(model: str) -> bool:
    """Whether the panels of a model bend.

    Raises:
        ValueError: if the model is none of MODELS.
    """
    return check_model(model).startswith(FLEXIBLE)


def has_clearance(model: str) -> bool:
    """Whether the joints of a model have clearance.

    Raises:
        ValueError: if the model is none of MODELS.
    """
    return check_model(model).endswith(CLEARANCE)
