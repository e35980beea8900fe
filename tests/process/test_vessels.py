"""Shapes of tanks against closed forms, quadrature, each other's derivatives, and bad files."""

import math

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import quad

from clepsydra import InputError
from clepsydra.process.document import parse
from clepsydra.process.table_reader import TableReader
from clepsydra.process.vessels.cone import Cone
from clepsydra.process.vessels.horizontal_cylinder import HorizontalCylinder
from clepsydra.process.vessels.prism import Prism
from clepsydra.process.vessels.reading import VESSEL_KEYS, read_vessel
from clepsydra.process.vessels.sphere_segment import SphereSegment
from clepsydra.process.vessels.table import AreaTable
from clepsydra.process.vessels.vessel import Vessel

VESSELS: dict[str, Vessel] = {
    "prism": Prism(height=0.2, area=28e-4),
    "drum": HorizontalCylinder(diameter=0.7, length=1.9),
    "cone on its point": Cone(height=0.6, floor_diameter=0.0, rim_diameter=0.4),
    "hopper": Cone(height=0.6, floor_diameter=0.05, rim_diameter=0.4),
    "narrowing cone": Cone(height=2.0, floor_diameter=1.5, rim_diameter=0.3),
    "closed cone": Cone(height=2.0, floor_diameter=1.5, rim_diameter=0.0),
    "nearly a cylinder": Cone(height=1.3, floor_diameter=1.0, rim_diameter=1.0 + 1e-9),
    "cylinder as a cone": Cone(height=1.3, floor_diameter=0.8, rim_diameter=0.8),
    "sphere": SphereSegment(height=3.0, diameter=3.0),
    "bowl": SphereSegment(height=0.5, diameter=3.0),
    "sphere with an opening": SphereSegment(height=2.8, diameter=3.0),
    "table": AreaTable(levels=(0.0, 0.2, 0.5, 0.9, 1.0), areas=(0.4, 1.0, 1.0, 0.3, 0.2)),
    "table from a point": AreaTable(levels=(0.0, 0.4, 1.0), areas=(0.0, 1.0, 1.5)),
    "table to a neck": AreaTable(levels=(0.0, 0.4, 1.0), areas=(2.0, 1.0, 1e-9)),
}
ROUNDING = np.finfo(float).eps


@pytest.fixture(params=list(VESSELS))
def vessel(request: pytest.FixtureRequest) -> Vessel:
    return VESSELS[request.param]


def function_of(vessel: Vessel, name: str) -> ca.Function:
    """Return (argument, parameters) → value, first and second derivative, gradient."""
    x = ca.SX.sym("x")
    parameters = vessel.parameters()
    p = ca.SX.sym("p", len(parameters))
    values = {parameter.name: p[i] for i, parameter in enumerate(parameters)}
    y = getattr(vessel, name)(x, values)
    y = ca.SX(y) + 0 * x
    slope = ca.jacobian(y, x)
    outputs = [y, slope, ca.jacobian(slope, x), ca.densify(ca.jacobian(y, p))]
    return ca.Function(name, [x, p], outputs)


def evaluate(vessel: Vessel, name: str, points: np.ndarray, output: int = 0) -> np.ndarray:
    """Return one output of `function_of` at each of the points."""
    return np.array(at_points(vessel, name, points)[output]).ravel()


def at_points(vessel: Vessel, name: str, points: np.ndarray) -> tuple[ca.DM, ...]:
    """Return all outputs of `function_of` at the points, side by side."""
    numbers = [parameter.initial for parameter in vessel.parameters()]
    return function_of(vessel, name)(np.asarray(points)[None, :], numbers)


def inner_levels(vessel: Vessel) -> np.ndarray:
    """Return levels dense towards floor and rim, and none at the corner of a table."""
    near = np.logspace(-9, -1, 33)
    shares = np.concatenate([near, np.linspace(0.1, 0.9, 101)[1:-1] + 1e-4, 1 - near[::-1]])
    return vessel.height * shares


def test_slope_of_volume_is_area(vessel: Vessel) -> None:
    levels = inner_levels(vessel)
    area, slope = evaluate(vessel, "surface", levels), evaluate(vessel, "volume", levels, 1)
    # At the two ends of a drum the slope is a small difference of terms that grow as 1/√h.
    mean = vessel.capacity / vessel.height
    ends = np.minimum(levels, vessel.height - levels) / vessel.height
    assert np.all(area > 0)
    assert np.all(np.abs(slope - area) <= 1e-13 * area + 2 * ROUNDING * mean / np.sqrt(ends))


def test_volume_is_the_integral_of_area(vessel: Vessel) -> None:
    function, numbers = function_of(vessel, "surface"), [p.initial for p in vessel.parameters()]
    corners = vessel.levels[1:-1] if isinstance(vessel, AreaTable) else None
    for share in (0.07, 0.31, 0.5, 0.83, 1.0):
        level = share * vessel.height
        inside = [corner for corner in corners or () if corner < level]
        integral, _ = quad(
            lambda h: float(function(h, numbers)[0]),
            0.0,
            level,
            epsabs=0.0,
            epsrel=1e-11,
            limit=200,
            points=inside or None,
        )
        assert evaluate(vessel, "volume", np.array([level]))[0] == pytest.approx(
            integral, rel=1e-10
        )


def test_level_is_the_inverse_of_volume(vessel: Vessel) -> None:
    """To 1e-12 of the height, or to what one rounding of the volume is in level."""
    levels = np.concatenate([inner_levels(vessel), vessel.height * np.array([-0.1, 1.05, 1.2])])
    volumes = evaluate(vessel, "volume", levels)
    back = evaluate(vessel, "level", volumes)
    rounding = ROUNDING * np.abs(volumes) / evaluate(vessel, "surface", levels)
    error = np.abs(back - levels)
    assert np.all(error <= 1e-12 * vessel.height + 3 * rounding)


def test_level_of_nothing_and_of_the_capacity(vessel: Vessel) -> None:
    ends = evaluate(vessel, "level", np.array([0.0, vessel.capacity]))
    assert ends[0] == 0.0
    assert abs(ends[1] - vessel.height) <= 1e-14 * vessel.height
    assert evaluate(vessel, "volume", np.array([0.0]))[0] == pytest.approx(
        0.0, abs=ROUNDING * vessel.capacity
    )


def test_volume_of_level_is_the_volume(vessel: Vessel) -> None:
    volumes = vessel.capacity * np.concatenate(
        [np.logspace(-20, -1, 39), np.linspace(-0.1, 1.2, 132)]
    )
    again = evaluate(vessel, "volume", evaluate(vessel, "level", volumes))
    np.testing.assert_allclose(again, volumes, rtol=0, atol=12 * ROUNDING * vessel.capacity)


def test_slope_of_level_is_one_over_area(vessel: Vessel) -> None:
    near = np.logspace(-9, -1, 25)
    shares = np.concatenate([near, np.linspace(0.101, 0.897, 77), 1 - np.logspace(-1, -6, 16)])
    volumes = vessel.capacity * shares
    area = evaluate(vessel, "surface", evaluate(vessel, "level", volumes))
    slope = evaluate(vessel, "level", volumes, 1)
    np.testing.assert_allclose(slope * area, 1.0, rtol=0, atol=1e-9)
    middle = (shares > 1e-3) & (shares < 0.999)
    np.testing.assert_allclose((slope * area)[middle], 1.0, rtol=0, atol=2e-12)


@pytest.mark.parametrize(
    ("vessel", "area"),
    [
        (HorizontalCylinder(diameter=2.0, length=3.0), 6.0),
        (SphereSegment(height=2.0, diameter=2.0), math.pi),
    ],
    ids=["drum", "sphere"],
)
def test_the_slopes_at_exactly_half_full(vessel: Vessel, area: float) -> None:
    """Where the filled part and the empty one are equal, and neither is the smaller."""
    half = vessel.capacity / 2
    for volume in (half, np.nextafter(half, 0.0), np.nextafter(half, 9.0)):
        assert evaluate(vessel, "level", [volume], 1) == pytest.approx(1 / area, rel=1e-12)
    for level in (1.0, np.nextafter(1.0, 0.0), np.nextafter(1.0, 2.0)):
        assert evaluate(vessel, "volume", [level], 1) == pytest.approx(area, rel=1e-12)


def test_level_over_parameters(vessel: Vessel) -> None:
    """∂h/∂p at a volume is -(∂V/∂p)/A at the level of that volume."""
    level, volume = function_of(vessel, "level"), function_of(vessel, "volume")
    numbers = [parameter.initial for parameter in vessel.parameters()]
    for share in (0.02, 0.3, 0.7, 0.98):
        content = share * vessel.capacity
        height, *_, gradient = level(content, numbers)
        _, area, _, by_parameter = volume(height, numbers)
        expected = -np.array(by_parameter).ravel() / float(area)
        # A parameter may act only by a difference of terms of the size of h/p.
        np.testing.assert_allclose(np.array(gradient).ravel(), expected, rtol=1e-10, atol=1e-10)


def test_every_volume_has_a_level_and_finite_derivatives(vessel: Vessel) -> None:
    edges = [0.0, -0.0, 5e-324, 1e-300, 1e-100, -1e-300, vessel.capacity]
    edges += [np.nextafter(vessel.capacity, 0), np.nextafter(vessel.capacity, 9e99)]
    volumes = np.concatenate([np.linspace(-0.1, 1.2, 261) * vessel.capacity, edges])
    for output in at_points(vessel, "level", volumes):
        assert np.all(np.isfinite(np.array(output)))


def test_every_level_has_a_volume_and_an_area(vessel: Vessel) -> None:
    levels = np.concatenate([np.linspace(-0.1, 1.2, 131), [1e-300, 5e-324, -1e-300]])
    for name in ("volume", "surface"):
        outputs = at_points(vessel, name, levels * vessel.height)
        assert all(np.all(np.isfinite(np.array(output))) for output in outputs), name


def test_level_rises_with_volume(vessel: Vessel) -> None:
    volumes = np.linspace(-0.1, 1.2, 1301) * vessel.capacity
    assert np.all(np.diff(evaluate(vessel, "level", volumes)) > 0)


def test_vertical_walls_beyond_floor_and_rim() -> None:
    hopper = VESSELS["hopper"]
    floor, rim = math.pi / 4 * 0.05**2, math.pi / 4 * 0.4**2
    mean = hopper.capacity / 0.6
    assert floor > 0.01 * mean
    outside = evaluate(hopper, "level", np.array([-1e-5, hopper.capacity + 1e-3]))
    np.testing.assert_allclose(outside, [-1e-5 / floor, 0.6 + 1e-3 / rim], rtol=1e-13)
    # A whole sphere has neither floor nor rim: a hundredth of its mean area stands for both.
    sphere = VESSELS["sphere"]
    hundredth = 0.01 * sphere.capacity / 3.0
    outside = evaluate(sphere, "level", np.array([-1e-4, sphere.capacity + 1e-4]))
    np.testing.assert_allclose(outside, [-1e-4 / hundredth, 3.0 + 1e-4 / hundredth], rtol=1e-9)


def volume_at(vessel: Vessel, level: float) -> float:
    return float(vessel.volume(level, vessel.values()))


def test_horizontal_cylinder_in_closed_form() -> None:
    drum = HorizontalCylinder(diameter=2.0, length=3.0)
    assert drum.capacity == pytest.approx(3 * math.pi, rel=1e-15)
    assert volume_at(drum, 1.0) == pytest.approx(1.5 * math.pi, rel=1e-15)
    # At a quarter of the height the half angle is 60°.
    quarter = 3 * (math.pi / 3 - math.sqrt(3) / 4)
    assert volume_at(drum, 0.5) == pytest.approx(quarter, rel=4e-15)
    assert volume_at(drum, 1.5) == pytest.approx(3 * math.pi - quarter, rel=1e-15)
    levels = evaluate(drum, "level", np.array([quarter, 1.5 * math.pi, 3 * math.pi - quarter]))
    np.testing.assert_allclose(levels, [0.5, 1.0, 1.5], rtol=1e-15)


@pytest.mark.parametrize("share", [1e-6, 1e-9, 1e-14, 1e-25])
def test_horizontal_cylinder_nearly_empty(share: float) -> None:
    """By series: x = (3πv/16)^(2/3), h/D = x + x²/5 + O(x³)."""
    drum = HorizontalCylinder(diameter=2.0, length=3.0)
    x = (3 * math.pi / 16 * share) ** (2 / 3)
    level = float(drum.level(share * drum.capacity, drum.values()))
    assert level / 2.0 == pytest.approx(x + x * x / 5, rel=max(1e-14, x * x))


def test_horizontal_cylinder_by_its_angle() -> None:
    """Kepler's equation forward: the share and the level of an angle are explicit."""
    drum = HorizontalCylinder(diameter=2.0, length=3.0)
    half_angle = np.linspace(0.05, math.pi - 0.05, 999)
    share = (half_angle - np.sin(2 * half_angle) / 2) / math.pi
    levels = evaluate(drum, "level", share * drum.capacity)
    np.testing.assert_allclose(levels, 1 - np.cos(half_angle), rtol=0, atol=5e-14)


def test_sphere_in_closed_form() -> None:
    sphere = SphereSegment(height=2.0, diameter=2.0)
    assert sphere.capacity == pytest.approx(4 / 3 * math.pi, rel=1e-15)
    assert volume_at(sphere, 1.0) == pytest.approx(2 / 3 * math.pi, rel=1e-15)
    bowl = SphereSegment(height=0.4, diameter=2.0)
    assert bowl.capacity == pytest.approx(math.pi * 0.4**2 * (1 - 0.4 / 3), rel=1e-15)
    # The inverse of v = 3 s² - 2 s³ by trigonometry.
    share = np.linspace(1e-3, 1 - 1e-3, 777)
    levels = evaluate(sphere, "level", share * sphere.capacity)
    expected = 1 - 2 * np.sin(np.arcsin(1 - 2 * share) / 3)
    np.testing.assert_allclose(levels, expected, rtol=0, atol=1e-13)


def test_frustum_in_closed_form() -> None:
    frustum = Cone(height=3.0, floor_diameter=2.0, rim_diameter=4.0)
    assert frustum.capacity == pytest.approx(7 * math.pi, rel=1e-15)
    turned = Cone(height=3.0, floor_diameter=4.0, rim_diameter=2.0)
    assert turned.capacity == pytest.approx(7 * math.pi, rel=1e-15)
    # What the one holds below a level the other leaves empty above its mirror image.
    for level in (0.3, 1.0, 2.4):
        rest = 7 * math.pi - volume_at(turned, 3.0 - level)
        assert volume_at(frustum, level) == pytest.approx(rest, rel=1e-13)
    point = Cone(height=3.0, floor_diameter=0.0, rim_diameter=2.0)
    np.testing.assert_allclose(
        evaluate(point, "level", math.pi * np.array([1 / 27, 1 / 8, 1.0])),
        [1.0, 1.5, 3.0],
        rtol=1e-15,
    )


def test_cone_without_slope_is_a_cylinder() -> None:
    cone, area = VESSELS["cylinder as a cone"], math.pi / 4 * 0.8**2
    volumes = np.linspace(-0.1, 1.2, 27) * cone.capacity
    np.testing.assert_allclose(evaluate(cone, "level", volumes), volumes / area, rtol=1e-14)


def test_table_in_closed_form() -> None:
    table = VESSELS["table"]
    # Trapezia: 0.2·0.7 = 0.14, 0.3·1.0 = 0.30, 0.4·0.65 = 0.26, 0.1·0.25 = 0.025.
    levels = np.array([0.2, 0.5, 0.9, 1.0, 1.1])
    volumes = np.array([0.14, 0.44, 0.70, 0.725, 0.725 + 0.1 * 0.2])
    np.testing.assert_allclose(evaluate(table, "volume", levels), volumes, rtol=1e-14)
    np.testing.assert_allclose(evaluate(table, "level", volumes), levels, rtol=1e-14)
    # Half-way up the first segment the area is 0.7: 0.1 · (0.4 + 0.7)/2.
    assert volume_at(table, 0.1) == pytest.approx(0.055, rel=1e-14)
    assert evaluate(table, "level", np.array([0.055]))[0] == pytest.approx(0.1, rel=1e-14)


def test_table_of_a_prism_and_of_a_wedge() -> None:
    box = AreaTable(levels=(0.0, 0.1, 0.2), areas=(28e-4, 28e-4, 28e-4))
    volumes = np.linspace(0.0, 1.2, 25) * box.capacity
    np.testing.assert_allclose(
        evaluate(box, "level", volumes),
        evaluate(VESSELS["prism"], "level", volumes),
        rtol=1e-14,
    )
    wedge = AreaTable(levels=(0.0, 2.0), areas=(0.0, 3.0))
    volumes = np.logspace(-12, 0, 25) * 3.0
    np.testing.assert_allclose(
        evaluate(wedge, "level", volumes), np.sqrt(4 * volumes / 3), rtol=1e-14
    )


def test_only_vertical_walls_are_uniform() -> None:
    assert [name for name, vessel in VESSELS.items() if vessel.uniform] == ["prism"]


def runge_kutta(rate: ca.Function, volume: float, duration: float, steps: int) -> np.ndarray:
    """Return the volumes after each step."""
    length, volumes = duration / steps, [volume]
    for _ in range(steps):
        v = volumes[-1]
        k1 = float(rate(v))
        k2 = float(rate(v + length / 2 * k1))
        k3 = float(rate(v + length / 2 * k2))
        k4 = float(rate(v + length * k3))
        volumes.append(v + length / 6 * (k1 + 2 * k2 + 2 * k3 + k4))
    return np.array(volumes)


def test_draining_cone() -> None:
    """A dh/dt = -a √(2 g h) with A = π k² h² gives h^(5/2) = h₀^(5/2) - 5 a √(2g)/(2 π k²) t."""
    cone = Cone(height=0.6, floor_diameter=0.0, rim_diameter=0.4)
    hole = 1e-4
    v = ca.SX.sym("v")
    level = ca.fmax(cone.level(v, cone.values()), 0)
    rate = ca.Function("rate", [v], [-hole * ca.sqrt(2 * 9.81 * level)])
    speed = 2.5 * hole * math.sqrt(2 * 9.81) / (math.pi * (0.2 / 0.6) ** 2)
    emptied = 0.5**2.5 / speed
    volumes = runge_kutta(rate, volume_at(cone, 0.5), 0.95 * emptied, 1900)
    time = np.linspace(0.0, 0.95 * emptied, 1901)
    expected = (0.5**2.5 - speed * time) ** 0.4
    np.testing.assert_allclose(evaluate(cone, "level", volumes), expected, rtol=0, atol=1e-10)
    # It runs empty and stays so: the last step takes too much, but less than the one before.
    drained = runge_kutta(rate, volume_at(cone, 0.5), 1.2 * emptied, 2400)
    first = int(np.argmax(drained <= 0))
    assert 1995 <= first <= 2005
    assert drained[first - 2] - drained[first - 1] > -drained[first] >= 0.0
    assert np.all(drained[first:] == drained[first])


def test_filling_sphere_from_empty() -> None:
    """At a constant flow V = q t, and the level follows by trigonometry."""
    sphere = SphereSegment(height=3.0, diameter=3.0)
    flow = sphere.capacity / 1000.0
    v = ca.SX.sym("v")
    volumes = runge_kutta(ca.Function("rate", [v], [ca.SX(flow) + 0 * v]), 0.0, 1000.0, 1000)
    share = np.linspace(0.0, 1.0, 1001)
    np.testing.assert_allclose(volumes, share * sphere.capacity, rtol=1e-12)
    levels = evaluate(sphere, "level", share * sphere.capacity)
    expected = 1.5 - 3.0 * np.sin(np.arcsin(1 - 2 * share) / 3)
    np.testing.assert_allclose(levels, expected, rtol=0, atol=1e-12)
    # Straight from the run, away from the top, where a rounding of volume is much of level.
    np.testing.assert_allclose(
        evaluate(sphere, "level", volumes)[:-10], expected[:-10], rtol=0, atol=1e-11
    )


def read(text: str) -> Vessel:
    content = f"[tanks.a]\n{text}\n".encode()
    return read_vessel(TableReader(parse(content, "plant.toml"), ("tanks", "a"), VESSEL_KEYS))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("area = '28 cm^2'\nheight = '20 cm'", Prism(0.2, 28e-4)),
        ("shape = 'prism'\narea = '28 cm^2'\nheight = '20 cm'", Prism(0.2, 28e-4)),
        ("diameter = '2 m'\nheight = '1 m'", Prism(1.0, math.pi)),
        (
            "shape = 'horizontal cylinder'\ndiameter = '2 m'\nlength = '300 cm'",
            HorizontalCylinder(2.0, 3.0),
        ),
        ("shape = 'cone'\nheight = '3 m'\nrim_diameter = '2 m'", Cone(3.0, 0.0, 2.0)),
        (
            "shape = 'cone'\nheight = '3 m'\nfloor_diameter = '1 m'\nrim_diameter = '0 m'",
            Cone(3.0, 1.0, 0.0),
        ),
        ("shape = 'sphere'\ndiameter = '2 m'", SphereSegment(diameter=2.0)),
        (
            "shape = 'sphere'\ndiameter = '2 m'\nheight = '0.5 m'",
            SphereSegment(height=0.5, diameter=2.0),
        ),
        (
            "shape = 'table'\ntable = [['0 m', '1 m^2'], ['50 cm', '2 m^2']]",
            AreaTable((0.0, 0.5), (1.0, 2.0)),
        ),
    ],
)
def test_reading(text: str, expected: Vessel) -> None:
    assert read(text) == expected


CONE = "shape = 'cone'\nheight = '3 m'\n"
EXAMPLE = 'write as in table = [["0 m", "1 m^2"], ["0.5 m", "2 m^2"]]'


def table_of(rows: str) -> str:
    return f"shape = 'table'\ntable = {rows}"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "shape = 'spere'\ndiameter = '1 m'",
            "line 2, tanks.a.shape: got 'spere', expected one of prism, horizontal cylinder, "
            "cone, sphere, table; perhaps 'sphere' was meant.",
        ),
        (
            "shape = 3\narea = '1 m^2'",
            "line 2, tanks.a.shape: got 3, expected one of prism, horizontal cylinder, cone, "
            "sphere, table; choose one.",
        ),
        (
            "height = '1 m'",
            "line 1, tanks.a.area: got no area, expected an area; give the cross-section of "
            'the tank, as in area = "1 m^2".',
        ),
        (
            "area = '1 m^2'\ndiameter = '1 m'\nheight = '1 m'",
            "line 3, tanks.a.diameter: got '1 m', expected either an area or a diameter; remove "
            "one of the two.",
        ),
        (
            "diameter = '0 cm'\nheight = '1 m'",
            "line 2, tanks.a.diameter: got '0 cm', expected a diameter above 0 cm; give the inner "
            "diameter of the tank.",
        ),
        (
            "area = '1 m^2'\nheight = '-1 m'",
            "line 3, tanks.a.height: got '-1 m', expected a height above 0 m; give the height of "
            "the rim above the floor.",
        ),
        (
            "shape = 'horizontal cylinder'\ndiameter = '1 m'\nheight = '1 m'",
            "line 4, tanks.a.height: got 'height', expected one of diameter, length for the shape "
            "horizontal cylinder; remove it, or choose the shape that it belongs to.",
        ),
        (
            "area = '1 m^2'\nheight = '1 m'\nlength = '2 m'",
            "line 4, tanks.a.length: got 'length', expected one of area, diameter, height for the "
            "shape prism; remove it, or choose the shape that it belongs to.",
        ),
        (
            "shape = 'horizontal cylinder'\ndiameter = '1 m'\nlength = '0 m'",
            "line 4, tanks.a.length: got '0 m', expected a length above 0 m; give the inner "
            "length of the tank.",
        ),
        (
            "shape = 'horizontal cylinder'\ndiameter = '1 m'",
            "line 1, tanks.a.length: got no length, expected a length; give the inner length "
            'of the tank, as in length = "1 m".',
        ),
        (
            CONE,
            "line 1, tanks.a.rim_diameter: got no rim_diameter, expected a diameter; give the "
            'inner diameter at the rim, 0 for a point, as in rim_diameter = "1 m".',
        ),
        (
            CONE + "rim_diameter = '0 m'",
            "line 4, tanks.a.rim_diameter: got '0 m', expected a diameter above 0 m at the floor "
            "or at the rim; correct one of the two diameters.",
        ),
        (
            CONE + "rim_diameter = '1 m'\nfloor_diameter = '-5 cm'",
            "line 5, tanks.a.floor_diameter: got '-5 cm', expected a diameter of at least 0 cm; "
            "give the inner diameter at the floor, 0 for a point.",
        ),
        (
            "shape = 'sphere'\ndiameter = '50 cm'\nheight = '60 cm'",
            "line 4, tanks.a.height: got '60 cm', expected a height of at most 50 cm; a sphere "
            "ends at its diameter: correct height or diameter.",
        ),
        (
            "shape = 'sphere'\ndiameter = '2 s'",
            "line 3, tanks.a.diameter: got '2 s', expected a quantity convertible to m; 's' "
            "measures something else: write it as in '1 m'.",
        ),
        (
            "shape = 'sphere'\ndiameter = '1e-10 m'",
            "line 1, tanks.a: got sizes of no tank, expected a capacity from 1e-15 m^3 to "
            "1e+15 m^3; check the units of the sizes.",
        ),
        (
            "shape = 'sphere'\ndiameter = '1e10 m'",
            "line 1, tanks.a: got sizes of no tank, expected a capacity from 1e-15 m^3 to "
            "1e+15 m^3; check the units of the sizes.",
        ),
        (
            "shape = 'table'",
            "line 1, tanks.a.table: got no table, expected a list of pairs of level and area; "
            + EXAMPLE
            + ".",
        ),
        (
            table_of("'0 m'"),
            "line 3, tanks.a.table: got '0 m', expected a list of pairs of level and area; "
            + EXAMPLE
            + ".",
        ),
        (
            table_of("[['0 m', '1 m^2'], ['1 m']]"),
            "line 3, tanks.a.table: got '[\"1 m\"]', expected a list of pairs of level and area; "
            + EXAMPLE
            + ".",
        ),
        (
            table_of("[['0 m', '1 m^2']]"),
            'line 3, tanks.a.table: got \'[["0 m", "1 m^2"]]\', expected at least two rows; '
            + EXAMPLE
            + ".",
        ),
        (
            table_of("[['1 m', '1 m^2'], ['2 m', '1 m^2']]"),
            "line 3, tanks.a.table: got '1 m', expected a first level of 0 m, the floor; measure "
            "the levels from the floor, and give the area there.",
        ),
        (
            table_of("[['0 m', '1 m^2'], ['2 m', '1 m^2'], ['1 m', '1 m^2']]"),
            "line 3, tanks.a.table: got '1 m', expected a level above 2 m, the one before it; "
            "sort the rows by their level, and give every level once.",
        ),
        (
            table_of("[['0 m', '-1 m^2'], ['2 m', '1 m^2']]"),
            "line 3, tanks.a.table: got '-1 m^2', expected an area of at least 0 m^2; correct "
            "the area.",
        ),
        (
            table_of("[['0 m', '1 m^2'], ['2 m', '0 m^2']]"),
            "line 3, tanks.a.table: got '0 m^2', expected an area above 0 m^2 at 2 m; correct "
            "the area.",
        ),
        (
            table_of("[['0 m', '1 m'], ['2 m', '1 m^2']]"),
            "line 3, tanks.a.table: got '1 m', expected a quantity convertible to m^2; 'm' "
            "measures something else: write it as in '1 m^2'.",
        ),
        (
            table_of("[[0, '1 m^2'], ['2 m', '1 m^2']]"),
            "line 3, tanks.a.table: got 0, expected a quantity convertible to m; the unit is "
            "missing: write it as in '1 m'.",
        ),
        (
            table_of("[['0 m', '1 m^2'], ['1 m', '2 m^2']]\nheight = '1 m'"),
            "line 4, tanks.a.height: got 'height', expected one of table for the shape table; "
            "remove it, or choose the shape that it belongs to.",
        ),
    ],
)
def test_bad_shapes(text: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        read(text)
    assert str(caught.value) == f"plant.toml, {message}"
