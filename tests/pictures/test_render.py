import dataclasses
import subprocess
import sys

import numpy as np
import pytest

from solar_env.pictures.raster import Layout, TextPen
from solar_env.pictures.render import Renderer
from solar_env.pictures.scene import Scene
from solar_env.pictures.style import COLOURS
from solar_env.pictures.views import (
    BOLT,
    JOURNAL_MARK,
    JOURNAL_SHARE,
    ArrayView,
    BearingView,
    journal_offset,
)

CLEARANCE = 2e-4
WHITE = 3 * 255
# Left, top, right and bottom of the contact forces in a frame of 960 x 540.
FORCES = (62, 370, 602, 500)
# How far the colour of a thin line may be blended with the white around it.
THIN = 95
TURN = np.radians(25.0)


def make_scene(joints=2, opening=0.0, turn=0.0, **changes):
    """A z-folded array, opened by a share of the way from folded to straight, turned about the main body."""
    swing = -np.pi / 2 * (1.0 - opening) * (-1.0) ** np.arange(joints)
    corners = np.concatenate([[[0.5, 0.0]], 1.5 * np.column_stack([np.cos(swing), np.sin(swing)])])
    corners = np.cumsum(corners, axis=0)
    body = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
    back = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    scene = Scene(
        time=3.0,
        main_body=body @ back,
        panels=tuple(corners[i : i + 2] @ back for i in range(joints)),
        hinges=corners[:-1] @ back,
        eccentricity=np.tile([0.6 * CLEARANCE, 0.0], (joints, 1)),
        clearance=np.full(joints, CLEARANCE),
        journal_radius=np.full(joints, 0.01),
        in_contact=np.zeros(joints, dtype=bool),
        normal_force=np.zeros(joints),
        latched=np.zeros(joints, dtype=bool),
        motor_torque=0.1,
        force_times=np.linspace(0.0, 3.0, 50),
        force_history=np.full((50, joints), 0.5),
    )
    return dataclasses.replace(scene, **changes)


def brightest(eccentricity, direction):
    """Largest sum of red, green and blue on a ray from the centre of the drawn first bearing; y is up."""
    scene = make_scene(eccentricity=np.array([eccentricity, [0.0, 0.0]]))
    size = (1920, 1080)
    view = BearingView(Layout(size), joint=0, shown=2)
    frame = Renderer(scene, size=size).draw(scene)
    away = np.arange(view.bearing_radius + 10.0)[:, None] * direction * [1.0, -1.0]
    x, y = np.round(view.centre + away).astype(int).T
    return int(frame[y, x].astype(int).sum(axis=1).max())


@pytest.mark.parametrize(("share", "touches"), [(0.8, False), (0.95, False), (1.0, True), (1.01, True)])
def test_drawn_journal_touches_the_bearing_exactly_when_eccentricity_reaches_the_clearance(share, touches):
    offset = journal_offset(np.array([0.6, -0.8]) * share * CLEARANCE, CLEARANCE, bearing_radius=100.0)
    assert (np.hypot(*offset) + 100.0 * JOURNAL_SHARE >= 100.0 - 1e-9) == touches
    assert (brightest([share * CLEARANCE, 0.0], np.array([1.0, 0.0])) < 0.9 * WHITE) == touches


@pytest.mark.parametrize("direction", [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)])
def test_gap_is_on_the_side_that_the_journal_has_left(direction):
    eccentricity = CLEARANCE * np.array(direction)
    assert brightest(eccentricity, np.array(direction)) < 0.9 * WHITE
    assert brightest(eccentricity, -np.array(direction)) == WHITE


def test_same_scene_gives_the_same_pixels_whatever_was_drawn_before():
    first, second = make_scene(opening=0.3), make_scene(opening=0.7)
    renderer = Renderer(make_scene())
    frame = renderer.draw(first)
    renderer.draw(second)
    np.testing.assert_array_equal(renderer.draw(first), frame)
    np.testing.assert_array_equal(Renderer(make_scene()).draw(first), frame)


@pytest.mark.parametrize(
    "change",
    [
        {"time": 3.5},
        {"motor_torque": -0.1},
        {"panels": make_scene(opening=0.4).panels},
        {"eccentricity": np.array([[0.0, 0.6], [0.0, 0.6]]) * CLEARANCE},
        {"clearance": np.array([CLEARANCE, 1.5 * CLEARANCE])},
        {"journal_radius": np.array([0.01, 0.02])},
        {"in_contact": np.array([False, True])},
        {"normal_force": np.array([0.0, 3.0])},
        {"latched": np.array([True, False])},
        {"force_history": np.full((50, 2), 50.0)},
    ],
    ids=lambda change: next(iter(change)),
)
def test_every_part_of_a_scene_shows(change):
    renderer, scene = Renderer(make_scene()), make_scene(opening=0.3)
    changed = renderer.draw(dataclasses.replace(scene, **change))
    assert np.any(changed != renderer.draw(scene))


def test_panels_are_drawn_along_their_curves():
    share = np.linspace(0.0, 1.0, 17)[:, None]
    straight = make_scene()
    start, tip = straight.panels[0][[0, -1]]
    bent = start + share * (tip - start) + 0.8 * share * (1.0 - share) * [1.0, 0.0]
    scene = make_scene(panels=(bent, straight.panels[1]))
    view = ArrayView(Layout((960, 540)), straight)
    frame = Renderer(straight).draw(scene).astype(int)
    blue = frame[..., 2] - frame[..., 0] > 60
    for point in bent[2:-2]:
        x, y = np.round(view.place(point)).astype(int)
        assert blue[y - 1 : y + 2, x - 1 : x + 2].any()
    x, y = np.round(view.place(bent[8] + [0.1, 0.0])).astype(int)
    assert not blue[y - 1 : y + 2, x - 1 : x + 2].any()


def test_the_marks_of_the_bearings_turn_with_the_ends_of_bent_panels():
    renderer, scene = Renderer(make_scene()), make_scene()
    straight = tuple(np.linspace(panel[0], panel[-1], 3) for panel in scene.panels)
    bent = tuple(panel + np.array([[0.0, 0.0], [0.3, 0.0], [0.0, 0.0]]) for panel in straight)
    bearings = [renderer.draw(make_scene(panels=panels))[:, 640:] for panels in (scene.panels, straight, bent)]
    np.testing.assert_array_equal(bearings[0], bearings[1])
    assert np.any(bearings[1] != bearings[2])


def test_force_arrow_grows_with_the_force():
    renderer = Renderer(make_scene())

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
    write = TextPen.write

    def keep(self, at, text, *style, **more):
        if more.get("anchor") == "rm":
            written[text] = at
        write(self, at, text, *style, **more)

    monkeypatch.setattr(TextPen, "write", keep)
    renderer = Renderer(make_scene())
    heights = []
    for force in (0.1, 1.0, 10.0, 100.0):
        frame = renderer.draw(make_scene(force_history=np.array([1.0, 1e-9]) * np.full((50, 2), force)))
        curve = pixels_like(frame, COLOURS[0], FORCES, THIN)
        heights.append(curve[:, 1].mean())
        assert written[f"{force:g}"][1] == pytest.approx(heights[-1], abs=1.0)
    assert np.diff(heights) == pytest.approx(np.full(3, heights[1] - heights[0]), abs=1.0)
    assert heights[-1] < heights[0] - 50.0, "rows are counted downwards"


@pytest.mark.parametrize("joint", [0, 1])
def test_a_contact_is_a_dot_at_its_force_at_the_present_time(joint):
    loads = {"in_contact": np.arange(2) == joint, "normal_force": np.array([300.0, 300.0])}
    scene = make_scene(force_times=np.zeros(0), force_history=np.zeros((0, 2)), **loads)
    dots = [pixels_like(Renderer(scene).draw(scene), COLOURS[k], FORCES) for k in (joint, 1 - joint)]
    history = {"force_times": np.array([0.0, 3.0]), "force_history": np.full((2, 2), 300.0)}
    curve = pixels_like(Renderer(scene).draw(make_scene(**history)), COLOURS[1], FORCES, THIN)
    assert dots[0][:, 1].mean() == pytest.approx(curve[:, 1].mean(), abs=1.0)
    assert dots[0][:, 0].mean() == pytest.approx(curve[:, 0].max(), abs=2.0)
    assert len(dots[1]) == 0


@pytest.mark.parametrize("latched", [(True, False), (False, True), (True, True), (False, False)])
def test_a_hinge_is_a_full_disc_where_it_has_latched_and_a_ring_where_it_has_not(latched):
    scene = make_scene(opening=0.6, latched=np.array(latched))
    frame = Renderer(scene).draw(scene)
    view = ArrayView(Layout((960, 540)), scene)
    for joint, (x, y) in enumerate(np.round(view.place(scene.hinges)).astype(int)):
        box = (x - 1, y - 1, x + 2, y + 2)
        inside = len(pixels_like(frame, COLOURS[joint], box)), len(pixels_like(frame, "#ffffff", box))
        assert inside == ((9, 0) if latched[joint] else (0, 9))


def turned_by(angle, points):
    """Points (k, 2) turned anticlockwise about the origin."""
    return points @ np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


def bolts_at(frame, joint, turn):
    """How many of the four bolts of a bearing are drawn where they belong when what carries it has turned."""
    view = BearingView(Layout((960, 540)), joint, shown=2)
    ring = 0.5 * (view.bearing_radius + view.bearing_radius / 0.84)
    found = 0
    for quarter in np.arange(4) * np.pi / 2.0:
        x, y = np.round(view.centre + ring * np.array([np.cos(turn + quarter), -np.sin(turn + quarter)])).astype(int)
        found += len(pixels_like(frame, BOLT, (x - 1, y - 1, x + 2, y + 2))) >= 5
    return found


def test_the_bolts_of_a_bearing_turn_with_the_body_that_carries_it_and_not_with_its_journal():
    scene = make_scene(opening=1.0)
    renderer = Renderer(make_scene())
    for turned, body in enumerate((scene.main_body, *scene.panels)):
        bodies = [scene.main_body, *scene.panels]
        bodies[turned] = turned_by(TURN, body)
        frame = renderer.draw(dataclasses.replace(scene, main_body=bodies[0], panels=tuple(bodies[1:])))
        for joint in (0, 1):
            expected = TURN if joint == turned else 0.0
            assert bolts_at(frame, joint, expected) == 4, (turned, joint)
            assert bolts_at(frame, joint, TURN - expected) == 0, (turned, joint)


def test_the_marks_of_a_journal_turn_with_its_own_panel():
    scene = make_scene(opening=1.0, eccentricity=np.zeros((2, 2)))
    renderer = Renderer(make_scene())
    for turned in (0, 1):
        panels = [turned_by(TURN, panel) if k == turned else panel for k, panel in enumerate(scene.panels)]
        frame = renderer.draw(dataclasses.replace(scene, panels=tuple(panels)))
        for joint in (0, 1):
            view = BearingView(Layout((960, 540)), joint, shown=2)
            reach = 0.4 * JOURNAL_SHARE * view.bearing_radius
            for turn in (0.0, TURN):
                x, y = np.round(view.centre + reach * np.array([np.cos(turn), -np.sin(turn)])).astype(int)
                marked = len(pixels_like(frame, JOURNAL_MARK, (x - 1, y - 1, x + 2, y + 2))) > 0
                assert marked == (turn == (TURN if joint == turned else 0.0)), (turned, joint, turn)


# The turn [deg] that conservation of angular momentum gives main bodies and panels of the default array.
@pytest.mark.parametrize(("joints", "turn"), [(1, -2.1), (2, -5.1), (3, -9.3), (5, -15.3), (8, -20.1)])
def test_view_holds_the_array_from_folded_to_deployed_and_turned(joints, turn):
    view = ArrayView(Layout((960, 540)), make_scene(joints))
    for opening in np.linspace(0.0, 1.0, 11):
        scene = make_scene(joints, opening, np.radians(turn) * opening)
        points = view.place(np.concatenate([scene.main_body, *scene.panels]))
        assert np.all(points > [18, 58])
        assert np.all(points < [610, 320])


def test_world_is_drawn_to_scale_and_upright():
    place = ArrayView(Layout((960, 540)), make_scene()).place
    origin, right, up = place([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    np.testing.assert_allclose(right - origin, [origin[1] - up[1], 0.0])
    assert right[0] > origin[0]


@pytest.mark.parametrize(("joints", "size"), [(1, (320, 180)), (3, (960, 540)), (8, (640, 640))])
def test_frame_has_the_size_asked_for(joints, size):
    frame = Renderer(make_scene(joints), size=size).draw(make_scene(joints, 0.5))
    assert frame.dtype == np.uint8
    assert frame.shape == (size[1], size[0], 3)


def test_ideal_joints_and_an_empty_history_are_drawn():
    scene = make_scene(
        clearance=np.zeros(2),
        eccentricity=np.zeros((2, 2)),
        force_times=np.zeros(0),
        force_history=np.zeros((0, 2)),
    )
    assert Renderer(scene).draw(scene).std() > 0.0


def test_a_brief_impact_shows_among_many_samples():
    times = np.linspace(0.0, 3.0, 30001)
    quiet = np.full((30001, 2), 0.5)
    impact = quiet.copy()
    impact[15000] = 300.0
    renderer = Renderer(make_scene())
    frames = [renderer.draw(make_scene(force_times=times, force_history=h)) for h in (quiet, impact)]
    assert np.any(frames[0] != frames[1])


def test_wrong_shape_is_named():
    with pytest.raises(ValueError, match=r"eccentricity has shape \(3, 2\), expected \(2, 2\)"):
        make_scene(eccentricity=np.zeros((3, 2)))
    with pytest.raises(ValueError, match="polyline"):
        make_scene(panels=(np.zeros((1, 2)), np.zeros((2, 2))))


def test_unusable_size_and_duration_are_refused():
    with pytest.raises(ValueError, match="at least 320 x 180"):
        Renderer(make_scene(), size=(100, 100))
    with pytest.raises(ValueError, match="duration"):
        Renderer(make_scene(), duration=0.0)


def test_importing_the_module_brings_no_drawing_library_and_no_compiler():
    code = "import sys, solar_env.pictures.render; print({'matplotlib', 'PIL', 'numba', 'torch'} & set(sys.modules))"
    printed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert printed.strip() == "set()"
