import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from hyperleg_design.errors import InfeasibleError, InputError
from hyperleg_design.robot import transmission
from hyperleg_design.robot.design import load_design
from hyperleg_design.sizing import slices, zonotope
from hyperleg_design.sizing.envelope import motor_envelope

SEEDS = st.integers(0, 2**32 - 1)


def random_set(seed, joints, motors):
    rng = np.random.default_rng(seed)
    return (
        rng,
        rng.normal(size=(joints, motors)) * 20,
        -rng.uniform(0.5, 3, motors),
        rng.uniform(0.5, 7, motors),
    )


def corners(matrix, lower, upper):
    """Images of all 2^m corners of the box of motor torques."""
    picks = np.array(np.meshgrid(*[(0, 1)] * len(lower), indexing="ij")).reshape(len(lower), -1).T
    return np.where(picks, upper, lower) @ matrix.T


def largest(matrix, lower, upper, direction, held=()):
    """Cvxpy's answer to `support`, with the torque of some joints held at zero."""
    motor = cp.Variable(len(lower))
    joint = matrix @ motor
    problem = cp.Problem(
        cp.Maximize(direction @ joint),
        [motor >= lower, motor <= upper, *(joint[i] == 0 for i in held)],
    )
    problem.solve(solver=cp.CLARABEL)
    return problem.value


def area(polygon):
    x, y = polygon.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


@pytest.fixture(scope="module", params=["toe", "toe_locked", "toe_removed"])
def leg(request):
    design = load_design("hyperleg", variant=request.param)
    peak = motor_envelope(design).peak_torque
    return transmission.joint_from_motor(design, "walking"), -peak, peak


@settings(max_examples=25, deadline=None)
@given(seed=SEEDS, shape=st.sampled_from([(3, 3), (4, 6), (6, 7)]))
def test_projection_is_the_hull_of_projected_corners(seed, shape):
    _, matrix, lower, upper = random_set(seed, *shape)
    polygon = slices.projection_polygon(matrix, lower, upper, (0, 2))
    hull = ConvexHull(corners(matrix, lower, upper)[:, [0, 2]])
    assert len(polygon) == 2 * shape[1]
    assert area(polygon) == pytest.approx(hull.volume, rel=1e-9)
    assert area(polygon) == pytest.approx(
        float(zonotope.volume(matrix[[0, 2]], lower, upper)), rel=1e-9
    )


def test_cut_of_two_joints_reaches_as_far_as_cvxpy(leg):
    matrix, lower, upper = leg
    polygon = slices.slice_polygon(matrix, lower, upper, (3, 4))
    assert area(polygon) > 0
    held = [i for i in range(len(matrix)) if i not in (3, 4)]
    for angle in np.linspace(0, 2 * np.pi, 8, endpoint=False):
        direction = np.zeros(len(matrix))
        direction[[3, 4]] = np.cos(angle), np.sin(angle)
        assert (polygon @ direction[[3, 4]]).max() == pytest.approx(
            largest(matrix, lower, upper, direction, held), rel=1e-6
        )


@settings(max_examples=25, deadline=None)
@given(seed=SEEDS, shape=st.sampled_from([(4, 4), (3, 5), (4, 5)]))
def test_corners_of_a_cut_lie_on_the_boundary(seed, shape):
    rng, matrix, lower, upper = random_set(seed, *shape)
    middle = matrix @ rng.uniform(lower, upper)
    held = {i: middle[i] for i in range(2, shape[0])}
    polygon = slices.slice_polygon(matrix, lower, upper, (0, 1), held)
    assert len(polygon) >= 3
    full = np.tile(middle, (len(polygon), 1))
    full[:, :2] = polygon
    assert zonotope.contains(matrix, lower, upper, full).all()
    beyond = full.copy()
    beyond[:, :2] += 1e-5 * (polygon - polygon.mean(0))
    assert not zonotope.contains(matrix, lower, upper, beyond).any()
    assert area(polygon) > 0, "anticlockwise"


def test_paper_leg_with_and_without_toe_motor():
    full, removed = load_design("hyperleg"), load_design("hyperleg", variant="toe_removed")
    cut, shadow = [], []
    for design in (full, removed):
        peak = motor_envelope(design).peak_torque[3:]
        below = transmission.joint_from_motor(design, "walking")[3:, 3:], -peak, peak
        cut.append(slices.slice_polygon(*below, (0, 1)))
        shadow.append(slices.projection_polygon(*below, (0, 1)))
    # with no toe torque the toe's motor helps neither knee nor ankle; with the toe pushing it does
    assert area(cut[0]) == pytest.approx(area(cut[1]))
    assert area(shadow[0]) > 1.5 * area(shadow[1])
    peak = motor_envelope(full).peak_torque[3:]
    np.testing.assert_allclose(
        shadow[0].max(0),
        zonotope.box(transmission.joint_from_motor(full, "walking")[3:5, 3:], -peak, peak)[1],
    )


def test_cuts_that_miss_or_touch():
    matrix, one = np.eye(3), np.ones(3)
    assert slices.slice_polygon(matrix, -one, one, (0, 1), {2: 1.5}).shape == (0, 2)
    assert len(slices.slice_polygon(matrix, -one, one, (0, 1), {2: 1.0})) == 4
    flat = np.array([1.0, 0.0, 1.0])
    assert len(slices.slice_polygon(matrix, -flat, flat, (0, 1))) == 2
    with pytest.raises(InfeasibleError):
        slices.slice_polyhedron(np.eye(4), -np.ones(4), np.ones(4), (0, 1, 2), {3: 2.0})
    with pytest.raises(InfeasibleError):
        slices.slice_polyhedron(matrix, -flat, flat, (0, 1, 2))


@settings(max_examples=20, deadline=None)
@given(seed=SEEDS, shape=st.sampled_from([(3, 3), (3, 5), (5, 6)]))
def test_shadow_in_three_joints_has_the_closed_form_volume(seed, shape):
    _, matrix, lower, upper = random_set(seed, *shape)
    body = slices.slice_polyhedron(matrix, lower, upper, (0, 1, 2), {})
    assert body.volume == pytest.approx(float(zonotope.volume(matrix[:3], lower, upper)), rel=1e-8)
    edges = {
        tuple(sorted(pair))
        for face in body.faces
        for pair in zip(face, np.roll(face, -1), strict=True)
    }
    assert len(body.vertices) - len(edges) + len(body.faces) == 2
    assert len(body.faces) == shape[1] * (shape[1] - 1)


def test_cut_in_three_joints_is_convex_and_faces_outward(leg):
    matrix, lower, upper = leg
    body = slices.slice_polyhedron(matrix, lower, upper, (3, 4, 5))
    assert body.volume == pytest.approx(ConvexHull(body.vertices).volume, rel=1e-9)
    centre = body.vertices.mean(0)
    for a, b, c in body.vertices[body.triangles]:
        assert np.cross(b - a, c - a) @ (a - centre) > 0
    full = np.zeros((len(body.vertices), len(matrix)))
    full[:, 3:6] = body.vertices
    assert zonotope.contains(matrix, lower, upper, full).all()
    assert not zonotope.contains(matrix, lower, upper, 1.0001 * full).any()


@pytest.mark.parametrize(
    ("joints", "held"), [((0, 0), None), ((0, 5), None), ((0, 1), {1: 0.0}), ((0, 1), {7: 0.0})]
)
def test_rows_that_are_not_there_are_refused(joints, held):
    with pytest.raises(InputError, match="rows"):
        slices.slice_polygon(np.eye(3), -np.ones(3), np.ones(3), joints, held)


def test_a_batch_of_sets_is_refused():
    with pytest.raises(InputError, match="one set"):
        slices.slice_polygon(np.tile(np.eye(3), (2, 1, 1)), -np.ones(3), np.ones(3), (0, 1))
