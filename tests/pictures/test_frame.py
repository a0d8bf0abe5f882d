import dataclasses

import numpy as np
import pytest

from solar_env.pictures.frame import (
    ARRAY_BOX,
    BOLT,
    FORCE_BOX,
    JOURNAL_MARK,
    JOURNAL_SHARE,
    Canvas,
    Renderer,
    Scene,
)
from solar_env.pictures.style import COLOURS

CLEARANCE = 2e-4
DURATION = 30.0
WHITE = 3 * 255
THIN = 95  # how far the colour of a thin line may be blended with the white around it
TURN = np.radians(25.0)


def make_scene(joints=2, opening=0.0, turn=0.0, **changes):
    """A z-folded array, opened by a share of the way from folded to straight, turned about the main body."""
    swing = -np.pi / 2 * (1.0 - opening) * (-1.0) ** np.arange(joints)
    corners = np.concatenate([[[0.5, 0.0]], 1.5 * np.column_stack([np.cos(swing), np.sin(swing)])])
    corners = turned_by(turn, np.cumsum(corners, axis=0))
    scene = Scene(
        time=3.0,
        main_body=turned_by(turn, np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])),
        panels=tuple(corners[i : i + 2] for i in range(joints)),
        hinges=corners[:-1],
        eccentricity=np.tile([0.6 * CLEARANCE, 0.0], (joints, 1)),
        clearance=np.full(joints, CLEARANCE),
        in_contact=np.zeros(joints, dtype=bool),
        normal_force=np.zeros(joints),
        latched=np.zeros(joints, dtype=bool),
        motor_torques=(0.1,),
        force_times=np.linspace(0.0, 3.0, 50),
        force_history=np.full((50, joints), 0.5),
    )
    return dataclasses.replace(scene, **changes)


def turned_by(angle, points):
    """Points (k, 2) turned anticlockwise about the origin."""
    return points @ np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


@pytest.fixture(scope="module")
def renderer():
    return Renderer(make_scene(), DURATION)


def brightest(renderer, eccentricity, direction):
    """Largest sum of red, green and blue on a ray from the centre of the drawn first bearing; y is up."""
    frame = renderer.draw(make_scene(eccentricity=np.array([eccentricity, [0.0, 0.0]])))
    centre, radius = renderer.bearing(0)
    away = np.arange(radius + 5.0)[:, None] * np.array(direction) * [1.0, -1.0]
    x, y = np.round(centre + away).astype(int).T
    return int(frame[y, x].astype(int).sum(axis=1).max())


@pytest.mark.parametrize(("share", "touches"), [(0.9, False), (1.0, True), (1.01, True)])
def test_drawn_journal_touches_the_bearing_exactly_when_eccentricity_reaches_the_clearance(renderer, share, touches):
    assert (brightest(renderer, [share * CLEARANCE, 0.0], (1.0, 0.0)) < 0.9 * WHITE) == touches


@pytest.mark.parametrize("direction", [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)])
def test_gap_is_on_the_side_that_the_journal_has_left(renderer, direction):
    eccentricity = CLEARANCE * np.array(direction)
    assert brightest(renderer, eccentricity, direction) < 0.9 * WHITE
    assert brightest(renderer, eccentricity, -np.array(direction)) == WHITE


def test_same_scene_gives_the_same_pixels_whatever_was_drawn_before(renderer):
    first, second = make_scene(opening=0.3), make_scene(opening=0.7)
    frame = renderer.draw(first)
    assert (frame.dtype, frame.shape) == (np.uint8, (540, 960, 3))
    renderer.draw(second)
    np.testing.assert_array_equal(renderer.draw(first), frame)
    np.testing.assert_array_equal(Renderer(make_scene(), DURATION).draw(first), frame)


@pytest.mark.parametrize(
    "change",
    [
        {"time": 3.5},
        {"motor_torques": (-0.1,)},
        {"panels": make_scene(opening=0.4).panels},
        {"eccentricity": np.array([[0.0, 0.6], [0.0, 0.6]]) * CLEARANCE},
        {"clearance": np.array([CLEARANCE, 1.5 * CLEARANCE])},
        {"in_contact": np.array([False, True])},
        {"normal_force": np.array([0.0, 3.0])},
        {"latched": np.array([True, False])},
        {"force_history": np.full((50, 2), 50.0)},
        {"clearance": np.zeros(2), "force_times": np.zeros(0), "force_history": np.zeros((0, 2))},
    ],
    ids=lambda change: next(iter(change)),
)
def test_every_part_of_a_scene_shows(renderer, change):
    scene = make_scene(opening=0.3)
    changed = renderer.draw(dataclasses.replace(scene, **change))
    assert np.any(changed != renderer.draw(scene))


def test_panels_are_drawn_along_their_curves(renderer):
    share = np.linspace(0.0, 1.0, 17)[:, None]
    straight = make_scene()
    start, tip = straight.panels[0][[0, -1]]
    bent = start + share * (tip - start) + 0.8 * share * (1.0 - share) * [1.0, 0.0]
    frame = renderer.draw(make_scene(panels=(bent, straight.panels[1]))).astype(int)
    blue = frame[..., 2] - frame[..., 0] > 60
    for point in bent[2:-2]:
        x, y = np.round(renderer.place(point)).astype(int)
        assert blue[y - 1 : y + 2, x - 1 : x + 2].any()
    x, y = np.round(renderer.place(bent[8] + [0.1, 0.0])).astype(int)
    assert not blue[y - 1 : y + 2, x - 1 : x + 2].any()


def test_the_marks_of_the_bearings_turn_with_the_ends_of_bent_panels(renderer):
    scene = make_scene()
    straight = tuple(np.linspace(panel[0], panel[-1], 3) for panel in scene.panels)
    bent = tuple(panel + np.array([[0.0, 0.0], [0.3, 0.0], [0.0, 0.0]]) for panel in straight)
    bearings = [renderer.draw(make_scene(panels=panels))[:, 640:] for panels in (scene.panels, straight, bent)]
    np.testing.assert_array_equal(bearings[0], bearings[1])
    assert np.any(bearings[1] != bearings[2])


def test_force_arrow_grows_with_the_force(renderer):
    def red_pixels(force):
        touching = {"eccentricity": np.tile([CLEARANCE, 0.0], (2, 1)), "in_contact": np.array([True, True])}
        frame = renderer.draw(make_scene(normal_force=np.full(2, force), **touching)).astype(int)
        return int(np.sum((frame[:, 640:, 0] > 180) & (frame[:, 640:, 1:].max(axis=2) < 90)))

    assert red_pixels(0.1) < red_pixels(10.0) < red_pixels(1000.0)


def pixels_like(frame, colour, box, within=24):
    """(n, 2) columns and rows of the pixels in left, top, right, bottom that have about a colour, as "#rrggbb"."""
    left, top, right, bottom = box
    wanted = [int(colour[k : k + 2], 16) for k in (1, 3, 5)]
    near = np.abs(frame[top:bottom, left:right].astype(int) - wanted).max(axis=2) < within
    rows, columns = np.nonzero(near)
    return np.column_stack([columns + left, rows + top])


def test_the_force_axis_rises_by_decades_and_its_scale_belongs_to_the_curves(monkeypatch):
    written = {}
    write = Canvas.write

    def keep(self, x, y, text, *style, **more):
        written.setdefault(text, y)  # the scale of the forces comes before that of time
        write(self, x, y, text, *style, **more)

    monkeypatch.setattr(Canvas, "write", keep)
    renderer = Renderer(make_scene(), DURATION)
    monkeypatch.undo()
    heights = []
    for force in (0.1, 1.0, 10.0, 100.0):
        frame = renderer.draw(make_scene(force_history=np.array([1.0, 1e-9]) * np.full((50, 2), force)))
        heights.append(pixels_like(frame, COLOURS[0], FORCE_BOX, THIN)[:, 1].mean())
        assert written[f"{force:g}"] == pytest.approx(heights[-1], abs=1.0)
    assert np.diff(heights) == pytest.approx(np.full(3, heights[1] - heights[0]), abs=1.0)
    assert heights[-1] < heights[0] - 50.0, "rows are counted downwards"


@pytest.mark.parametrize("joint", [0, 1])
def test_a_contact_is_a_dot_at_its_force_at_the_present_time(renderer, joint):
    loads = {"in_contact": np.arange(2) == joint, "normal_force": np.array([300.0, 300.0])}
    scene = make_scene(force_times=np.zeros(0), force_history=np.zeros((0, 2)), **loads)
    dots = [pixels_like(renderer.draw(scene), COLOURS[k], FORCE_BOX) for k in (joint, 1 - joint)]
    history = {"force_times": np.array([0.0, 3.0]), "force_history": np.full((2, 2), 300.0)}
    curve = pixels_like(renderer.draw(make_scene(**history)), COLOURS[1], FORCE_BOX, THIN)
    assert dots[0][:, 1].mean() == pytest.approx(curve[:, 1].mean(), abs=1.0)
    assert dots[0][:, 0].mean() == pytest.approx(curve[:, 0].max(), abs=2.0)
    assert len(dots[1]) == 0


@pytest.mark.parametrize("latched", [(True, False), (False, True)])
def test_a_hinge_is_a_full_disc_where_it_has_latched_and_a_ring_where_it_has_not(renderer, latched):
    scene = make_scene(opening=0.6, latched=np.array(latched))
    frame = renderer.draw(scene)
    for joint, (x, y) in enumerate(np.round(renderer.place(scene.hinges)).astype(int)):
        box = (x - 1, y - 1, x + 2, y + 2)
        inside = len(pixels_like(frame, COLOURS[joint], box)), len(pixels_like(frame, "#ffffff", box))
        assert inside == ((9, 0) if latched[joint] else (0, 9))


def marks_at(renderer, frame, joint, colour, reach, turn):
    """How many of the four marks at a reach from a bearing's centre are drawn where what carries them has turned."""
    centre, radius = renderer.bearing(joint)
    found = 0
    for quarter in np.arange(4) * np.pi / 2.0:
        outward = np.array([np.cos(turn + quarter), -np.sin(turn + quarter)])
        x, y = np.round(centre + reach * radius * outward).astype(int)
        found += len(pixels_like(frame, colour, (x - 1, y - 1, x + 2, y + 2))) >= 3
    return found


def test_bolts_turn_with_the_body_that_carries_the_bearing_and_marks_of_a_journal_with_its_own_panel(renderer):
    scene = make_scene(opening=1.0, eccentricity=np.zeros((2, 2)))
    for turned, body in enumerate((scene.main_body, *scene.panels)):
        bodies = [scene.main_body, *scene.panels]
        bodies[turned] = turned_by(TURN, body)
        frame = renderer.draw(dataclasses.replace(scene, main_body=bodies[0], panels=tuple(bodies[1:])))
        for joint in (0, 1):
            for colour, reach, carrier in ((BOLT, 1.095, joint), (JOURNAL_MARK, 0.4 * JOURNAL_SHARE, joint + 1)):
                expected = TURN if carrier == turned else 0.0
                assert marks_at(renderer, frame, joint, colour, reach, expected) == 4, (turned, joint, colour)
                assert marks_at(renderer, frame, joint, colour, reach, TURN - expected) == 0, (turned, joint, colour)


# The turn [deg] that conservation of angular momentum gives main bodies and panels of the default array.
@pytest.mark.parametrize(("joints", "turn"), [(1, -2.1), (2, -5.1), (3, -9.3), (5, -15.3), (8, -20.1)])
def test_view_holds_the_array_from_folded_to_deployed_and_turned(joints, turn):
    renderer = Renderer(make_scene(joints), DURATION)
    for opening in np.linspace(0.0, 1.0, 11):
        scene = make_scene(joints, opening, np.radians(turn) * opening)
        points = renderer.place(np.concatenate([scene.main_body, *scene.panels]))
        assert np.all(points > ARRAY_BOX[:2])
        assert np.all(points < ARRAY_BOX[2:])
    origin, right, up = renderer.place([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    np.testing.assert_allclose(right - origin, [origin[1] - up[1], 0.0])
    assert right[0] > origin[0]


def test_a_brief_impact_shows_among_many_samples(renderer):
    times = np.linspace(0.0, 3.0, 30001)
    quiet = np.full((30001, 2), 0.5)
    impact = quiet.copy()
    impact[15000] = 300.0
    frames = [renderer.draw(make_scene(force_times=times, force_history=h)) for h in (quiet, impact)]
    assert np.any(frames[0] != frames[1])
