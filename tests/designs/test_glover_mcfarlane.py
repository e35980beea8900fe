"""Glover-McFarlane loop shaping against closed forms, continuous Riccati equations and sweeps."""

import functools
import math
from dataclasses import replace

import numpy as np
import pytest
from refusals import refused
from scipy.linalg import solve_continuous_are, solve_discrete_lyapunov

import clepsydra as cl
from clepsydra import NotApplicable, PidForm, Signal, python_law
from clepsydra.base.signal import effect, elements, path
from clepsydra.designs.glover_mcfarlane import REDUCTION_COST, design_glover_mcfarlane
from clepsydra.designs.loop_shaping.coprime_factors import coprime_factors
from clepsydra.designs.loop_shaping.order_reduction import reduced_plant
from clepsydra.designs.loop_shaping.precompensator import Precompensator, precompensator_of
from clepsydra.designs.loop_shaping.robust_controller import robust_controller
from clepsydra.designs.loop_shaping.shaped_plant import shaped_plant
from clepsydra.designs.lqi import design_lqi
from clepsydra.designs.own_law import own_controller
from clepsydra.designs.phase_margin import design_phase_margin
from clepsydra.designs.sampled.sampled_loop import sampled_loop
from clepsydra.designs.sampled.sampled_system import SampledSystem
from clepsydra.designs.simc import design_simc
from clepsydra.loop.loop import Loop
from clepsydra.loop.scenario import Scenario
from clepsydra.process.catalogue_names import catalogue_names

ANGLES = np.concatenate([np.geomspace(1e-6, math.pi, 6000), [math.pi]])


@functools.cache
def analysed(name):
    return cl.load(name).analysis


def random_plant(seed, n, m, q, radius=1.05):
    """A plant with a mode that does not die out."""
    random = np.random.default_rng(seed)
    A = random.normal(size=(n, n))
    A *= radius / np.max(np.abs(np.linalg.eigvals(A)))
    return SampledSystem(A, random.normal(size=(n, m)), random.normal(size=(q, n)),
                         np.zeros((q, m)))  # fmt: skip


def shaped(name):
    analysis = analysed(name)
    simc = design_simc(analysis.model, analysis.pairing)
    return shaped_plant(analysis.model, precompensator_of(simc, analysis.model))


def response(system, angles=ANGLES):
    """The transfer function, written out, not by the code under test."""
    z = np.exp(1j * angles)[:, None, None]
    return system.C @ np.linalg.solve(z * np.eye(len(system.A)) - system.A, system.B) + system.D


def swept_norm(plant, controller):
    G, K = response(plant), response(controller)
    q = G.shape[1]
    out = np.concatenate([K, np.broadcast_to(np.eye(q), (len(K), q, q))], axis=1)
    into = np.concatenate([np.broadcast_to(np.eye(q), (len(G), q, q)), G], axis=2)
    return float(
        np.linalg.norm(out @ np.linalg.inv(np.eye(q) - G @ K) @ into, 2, axis=(1, 2)).max()
    )


PLANTS = {
    "2 x 2": random_plant(1, 4, 2, 2),
    "1 x 3": random_plant(2, 5, 3, 1),
    "3 x 1": random_plant(3, 3, 1, 3),
    "stable": random_plant(4, 4, 2, 2, radius=0.8),
    "unstable": random_plant(5, 2, 1, 1, radius=1.4),
}


@pytest.mark.parametrize("b", [0.01, 0.3, 1.0, 5.0])
def test_gamma_of_an_integrator_in_closed_form(b):
    """x⁺ = x + b u: X = (1 + √(1 + 4/b²))/2 and Z = b² X by hand, so γ_min = √(1 + b² X²)."""
    one = np.eye(1)
    factors = coprime_factors(SampledSystem(one, b * one, one, 0.0 * one))
    X = (1.0 + math.sqrt(1.0 + 4.0 / b**2)) / 2.0
    assert factors.smallest_gamma == pytest.approx(math.sqrt(1.0 + b**2 * X**2), rel=1e-12)
    if b == 0.01:  # a continuous integrator has √2
        assert factors.smallest_gamma == pytest.approx(math.sqrt(2.0), abs=4e-3)


@pytest.mark.parametrize("name", PLANTS)
def test_gamma_by_the_riccati_equations_of_the_continuous_image(name):
    """A second route: SciPy's continuous equations after the bilinear map, with D."""
    plant = PLANTS[name]
    A, B, C, D = plant.continuous_image()
    m, q = B.shape[1], C.shape[0]
    S, R = np.eye(m) + D.T @ D, np.eye(q) + D @ D.T
    inner = A - B @ np.linalg.solve(S, D.T @ C)
    X = solve_continuous_are(inner, B, C.T @ np.linalg.solve(R, C), S)
    Z = solve_continuous_are(inner.T, C.T, B @ np.linalg.solve(S, B.T), R)
    gamma = math.sqrt(1.0 + float(np.max(np.linalg.eigvals(X @ Z).real)))
    assert coprime_factors(plant).smallest_gamma == pytest.approx(gamma, rel=1e-9)


@pytest.mark.parametrize("name", PLANTS)
def test_gamma_by_the_hankel_norm_of_the_coprime_factors(name):
    """A third route: Gramians by discrete Lyapunov equations."""
    factors = coprime_factors(PLANTS[name])
    A, B, C, _ = factors.system
    reached = solve_discrete_lyapunov(A, B @ B.T)
    seen = solve_discrete_lyapunov(A.T, C.T @ C)
    hankel = math.sqrt(float(np.max(np.linalg.eigvals(reached @ seen).real)))
    assert hankel < 1.0
    # 1/√(1 − σ²) magnifies what is left of the Lyapunov equations where σ is nearly one.
    room = 1e-12 * factors.smallest_gamma**2
    assert factors.smallest_gamma == pytest.approx((1.0 - hankel**2) ** -0.5, rel=1e-9 + room)
    assert factors.hankel_singular_values[0] == pytest.approx(hankel, rel=1e-9)


@pytest.mark.parametrize("name", PLANTS)
def test_factors_are_normalised_and_make_the_plant(name):
    plant = PLANTS[name]
    factors = coprime_factors(plant)
    m = plant.B.shape[1]
    values = response(factors.system, ANGLES[::20])
    product = values @ values.conj().transpose(0, 2, 1)
    assert np.abs(product - np.eye(len(plant.C))).max() < 1e-9
    quotient = np.linalg.solve(values[:, :, m:], values[:, :, :m])
    assert np.allclose(quotient, response(plant, ANGLES[::20]), rtol=1e-8, atol=1e-9)
    assert factors.system.is_stable


@pytest.mark.parametrize("name", PLANTS)
def test_riccati_residuals(name):
    """Regulator, observer, and the game between controller and disturbance."""
    A, B, C, _ = plant = PLANTS[name]
    factors = coprime_factors(plant)
    X, Z, root = factors.X, factors.Z, factors.root
    m, q = B.shape[1], C.shape[0]

    def left(P, known, moved, cost):
        gain = np.linalg.solve(np.eye(moved.shape[1]) + moved.T @ P @ moved, moved.T @ P @ known)
        whole = known.T @ P @ known - known.T @ P @ moved @ gain + cost - P
        return np.abs(whole).max() / np.abs(P).max()

    assert left(X, A, B, C.T @ C) < 1e-9
    assert left(Z, A.T, C.T, B @ B.T) < 1e-9
    controller = robust_controller(factors)
    gamma = controller.gamma
    P = np.linalg.solve((1 - gamma**-2) * np.eye(len(A)) - gamma**-2 * X @ Z, X)
    # x⁺ = A x + W w + B u against γ² |w|², with y = C x + S^½ w known at once.
    W = -factors.injection @ root
    both = np.hstack([W, B])
    weight = both.T @ P @ both + np.block(
        [
            [root.T @ root - gamma**2 * np.eye(q), np.zeros((q, m))],
            [np.zeros((m, q)), np.eye(m)],
        ]
    )
    cross = both.T @ P @ A + np.vstack([root.T @ C, np.zeros((m, len(A)))])
    rest = A.T @ P @ A + C.T @ C - cross.T @ np.linalg.solve(weight, cross) - P
    assert np.abs(rest).max() / np.abs(P).max() < 1e-9
    assert np.min(np.linalg.eigvalsh((P + P.T) / 2)) >= 0.0


@pytest.mark.parametrize("name", PLANTS)
@pytest.mark.parametrize("relaxation", [1.02, 1.1, 2.0])
def test_achieved_norm_against_a_frequency_sweep(name, relaxation):
    factors = coprime_factors(PLANTS[name])
    controller = robust_controller(factors, relaxation)
    achieved = controller.achieved_norm(PLANTS[name])
    swept = swept_norm(PLANTS[name], controller.system)
    assert swept <= achieved * (1.0 + 1e-9)
    assert achieved == pytest.approx(swept, rel=1e-4)
    assert factors.smallest_gamma * (1.0 - 1e-9) <= achieved < controller.gamma


@pytest.mark.parametrize("seed", range(6))
def test_no_controller_gets_below_gamma(seed):
    """Observers with other feedbacks: whatever stabilises has a norm of γ_min or more."""
    random = np.random.default_rng(seed)
    plant = PLANTS["2 x 2"]
    factors = coprime_factors(plant)
    best = robust_controller(factors)
    size = np.abs(best.feedback).max()
    for _ in range(20):
        other = replace(best, feedback=best.feedback + 0.1 * size * random.normal(size=(2, 4)))
        assert other.achieved_norm(plant) >= factors.smallest_gamma * (1.0 - 1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_what_the_norm_promises_is_borne(seed):
    """Random differences of the coprime factors just below 1/γ leave the loop stable."""
    random = np.random.default_rng(seed)
    plant = PLANTS["2 x 2"]
    factors = coprime_factors(plant)
    controller = robust_controller(factors)
    borne = 0.99 / controller.achieved_norm(plant)
    A, B, C, D = factors.system
    K = controller.system
    for _ in range(30):
        # A static difference Δ of norm `borne`: (M + ΔM)⁻¹ (N + ΔN).
        delta = random.normal(size=D.shape)
        delta *= borne / np.linalg.norm(delta, 2)
        N, M = (D + delta)[:, :2], (D + delta)[:, 2:]
        c, d = np.linalg.solve(M, C), np.linalg.solve(M, N)
        a, b = A - B[:, 2:] @ c, B[:, :2] - B[:, 2:] @ d
        # y = c x + d u, u = K y
        inverse = np.linalg.inv(np.eye(2) - d @ K.D)
        y_x, y_k = inverse @ c, inverse @ d @ K.C
        closed = np.block(
            [[a + b @ K.D @ y_x, b @ (K.C + K.D @ y_k)], [K.B @ y_x, K.A + K.B @ y_k]]
        )
        assert np.max(np.abs(np.linalg.eigvals(closed))) < 1.0


@pytest.mark.parametrize("order", [1, 2, 3, 4, 5])
def test_reduction_keeps_its_bound(order):
    factors = coprime_factors(shaped("quadruple-tank").system)
    small = reduced_plant(factors, order)
    again = coprime_factors(factors.plant)
    # The factors of the reduction, read off it by the truncated observer.
    assert small.A.shape == (order, order) and not small.D.any()
    full = response(again.system)
    weight = np.linalg.inv(factors.root)
    reached, seen = factors.roots
    left, values, right = np.linalg.svd(seen.T @ reached)
    scale = 1.0 / np.sqrt(values[:order])
    into, back = (scale[:, None] * left.T[:order]) @ seen.T, reached @ (right[:order].T * scale)
    A, B, C, D = factors.system
    truncated = SampledSystem(into @ A @ back, into @ B, C @ back, D)
    off = np.linalg.norm(full - response(truncated), 2, axis=(1, 2)).max()
    assert off <= 2.0 * factors.hankel_singular_values[order:].sum() * (1.0 + 1e-9)
    # The plant is the quotient of these factors.
    values = response(truncated, ANGLES[::50])
    assert np.allclose(np.linalg.solve(values[:, :, 2:], values[:, :, :2]),
                       response(small, ANGLES[::50]), rtol=1e-7)  # fmt: skip
    assert np.allclose(weight @ factors.root, np.eye(2))


def test_full_order_reduction_is_the_plant_itself():
    plant = PLANTS["2 x 2"]
    reduced = reduced_plant(coprime_factors(plant), 4)
    assert np.allclose(response(reduced, ANGLES[::50]), response(plant, ANGLES[::50]))


def test_largest_gain_is_found_beside_a_gain_at_half_the_sampling_frequency():
    """Sensitivity just above one there, and a peak a little higher far below."""
    process = "laboratory-four-tanks"
    analysis = analysed(process)
    controller = design_phase_margin(analysis.model, analysis.pairing, crossover=0.35)
    loop = sampled_loop(controller, analysis.model)
    swept = np.linalg.norm(response(loop), 2, axis=(1, 2))
    last = swept[-1]
    assert swept.max() > last > 1.0  # the case that is meant
    assert loop.maximum_sensitivity == pytest.approx(swept.max(), rel=1e-3)


def test_tustins_rule_takes_frequencies_to_their_tangent():
    A = np.array([[0.0, 1.0], [-0.2, -0.7]])
    B, C, D = np.array([[1.0], [0.5]]), np.array([[0.3, 1.0]]), np.array([[2.0]])
    angles, period = np.linspace(0.1, 3.0, 30), 0.5
    found = SampledSystem.by_tustins_rule((A, B, C, D), period).response(angles)
    s = 2.0j / period * np.tan(angles / 2.0)
    continuous = C @ np.linalg.solve(s[:, None, None] * np.eye(2) - A, B) + D
    assert np.allclose(found, continuous, rtol=1e-12)


@pytest.mark.parametrize(
    "name, decoupling",
    [("quadruple-tank", None), ("quadruple-tank", "dynamic"), ("three-tanks", None)],
)
def test_the_law_is_precompensator_times_robust_controller(name, decoupling, linear_law):
    """Broken up again by another way than it was joined: u = −W₁ S K S⁻¹ e."""
    analysis = analysed(name)
    model = analysis.model
    simc = design_simc(model, analysis.pairing, decoupling=decoupling)
    shaping = precompensator_of(simc, model)
    plant = shaped_plant(model, shaping)
    order = len(plant.system.A)
    controller = design_glover_mcfarlane(model, analysis.pairing, precompensator=simc, order=order)
    robust = robust_controller(coprime_factors(plant.system))
    angles = ANGLES[::50]
    sizes = np.diag(plant.sizes)
    expected = -(
        response(shaping.system, angles) @ sizes @ response(robust.system, angles)
        @ np.linalg.inv(sizes)
    )  # fmt: skip
    A, B, C, D = linear_law(controller, model.point)
    q = len(controller.setpoints)
    found = response(SampledSystem(A, -B[:, q:], C, -D[:, q:]), angles)
    assert np.allclose(found, expected, rtol=1e-6, atol=1e-9 * np.abs(expected).max())


@pytest.mark.sampled
@pytest.mark.parametrize("name", catalogue_names())
def test_it_is_robust_on_every_process_of_the_catalogue(name):
    analysis = analysed(name)
    controller = design_glover_mcfarlane(analysis.model, analysis.pairing)
    loop = sampled_loop(controller, analysis.model)
    assert loop.is_stable and loop.maximum_sensitivity < 2.0
    # The order is the lowest that keeps the norm within two per cent of what full order keeps.
    plant = shaped(name)
    full = coprime_factors(plant.system)
    order = sum(s.startswith("memory.") for s in controller.initial_state) - len(
        plant.precompensator.system.A
    )
    limit = 1.1 * full.smallest_gamma * REDUCTION_COST
    for tried in (order, order - 1):
        if tried < 1:
            continue
        factors = full if tried == len(full.X) else coprime_factors(reduced_plant(full, tried))
        kept = robust_controller(factors).achieved_norm(plant.system)
        assert (kept <= limit) == (tried == order)


def out_of_reach(loop, size, samples, back):
    """A setpoint far up for a while, which the pumps cannot reach, then where it began."""
    at = loop.point.as_dict()
    start = np.array([at[name] for name in loop.process.controlled])
    setpoints = np.tile(start, (samples, 1))
    setpoints[10:back, 0] += size
    return Scenario(loop.process.sampling_period, setpoints,
                    np.tile(loop.point.disturbances, (samples, 1)),
                    np.zeros((samples, len(loop.process.measurements))), (), 1)  # fmt: skip


def matrices(controller):
    """Return A, B, M, C and D of z⁺ = A z + B e + M u, u = C z + D e."""
    z = [name for name in controller.initial_state if name.startswith("memory.")]
    u, y = controller.manipulated, controller.measurements
    ends = {
        "transition": (z, z),
        "error_effect": (z, y),
        "output_effect": (z, u),
        "memory_gain": (u, z),
        "error_gain": (u, y),
    }
    return {
        name: np.array(
            [[controller.values.get(effect(i, name, j), 0.0) for j in columns] for i in rows]
        )
        for name, (rows, columns) in ends.items()
    }


def untold(controller):
    """Return A, B, C and D of the same controller that hears of no limit: u = C x + D e."""
    A, B, told, C, D = matrices(controller).values()
    return A + told @ C, B + told @ D, C, D


def without_conditioning(controller, model):
    """Return it as a law of its own, within the same limits, of which it does not hear."""
    A, B, C, D = untold(controller)

    memory = elements("memory", len(A))
    pv, sp = ([f"{y}.{part}" for y in controller.measurements] for part in ("pv", "sp"))
    bias, out = ([f"{u}.{part}" for u in controller.manipulated] for part in ("bias", "out"))

    def step(state, inputs, parameters, time_step):
        x, y, r, u = (
            np.array([given[name] for name in names])
            for given, names in ((state, memory), (inputs, pv), (inputs, sp), (parameters, bias))
        )
        e = y - r
        return (
            dict(zip(memory, A @ x + B @ e, strict=True)),
            dict(zip(out, u + C @ x + D @ e, strict=True)),
        )

    def signals(names):
        return [Signal(name) for name in names]

    law = python_law(
        "untold",
        step,
        inputs=signals(sp + pv),
        parameters=signals(bias),
        state=signals(memory),
        outputs=signals(out),
    )
    kept = ("bias", "low_limit", "high_limit")
    values = {path(u, part) for u in controller.manipulated for part in kept}
    return own_controller(
        model,
        law,
        measurements=controller.measurements,
        setpoints=controller.setpoints,
        manipulated=controller.manipulated,
        values={name: controller.values[name] for name in values},
    )


def test_saturation_does_not_wind_it_up():
    """Pumps that may give 3.3 V of 10 V cannot reach the setpoint in five minutes."""
    analysis = analysed("quadruple-tank")
    told = design_glover_mcfarlane(analysis.model, analysis.pairing)
    told = replace(told, values=told.values | {"pump_1.high_limit": 3.3, "pump_2.high_limit": 3.3})
    outcome = {}
    deaf = without_conditioning(told, analysis.model)
    for key, controller in (("told", told), ("untold", deaf)):
        run = Loop(controller, analysis.model).run(
            out_of_reach(Loop(controller, analysis.model), 3.0, 900, 310)
        )
        assert run.values["pump_1"][300] == 3.3
        leaves = np.flatnonzero(run.values["pump_1"][310:] < 3.3)
        error = run.values["level_1"][310:] - run.values["level_1.setpoint"][310:]
        outcome[key] = (int(leaves[0]) if len(leaves) else 590, float(np.abs(error).sum()))
    # The limit is left within a sixth of the lag of tank 1, 62 s, once the setpoint is back.
    assert outcome["told"][0] < 10 and outcome["untold"][0] > 100
    assert outcome["told"][1] < 0.2 * outcome["untold"][1]


@pytest.mark.parametrize(
    ("option", "value"),
    [
        *(("relaxation", value) for value in (1.0, 0.5, math.nan, "1.1")),
        *(("order", value) for value in (0, 7, 2.0, True)),
    ],
)
def test_a_number_out_of_range_is_refused(option, value):
    analysis = analysed("quadruple-tank")
    with refused(place=option):
        design_glover_mcfarlane(analysis.model, analysis.pairing, **{option: value})


def weighted(model, pairing):
    """Return PI control that answers to setpoint and measurement differently."""
    simc = design_simc(model, pairing)
    halved = {"level_1.setpoint_weight": 0.5}
    remembered = {"level_1.last_setpoint_weight": 0.5}
    return replace(simc, values=simc.values | halved, initial_state=simc.initial_state | remembered)


@pytest.mark.parametrize(
    ("name", "precompensator", "expected"),
    [
        ("quadruple-tank", lambda *_: "PI", "Controller or a Precompensator"),
        ("quadruple-tank", lambda model, _: design_lqi(model), "that have setpoints alone"),
        ("quadruple-tank", weighted, "of the control errors alone"),
        (
            "three-tanks",
            lambda model, pairing: design_simc(model, pairing, form=PidForm("PID")),
            "of the control errors alone",
        ),
    ],
    ids=["text", "states", "setpoint weight", "derivative of the measurement"],
)
def test_what_is_no_precompensator_is_refused(name, precompensator, expected):
    given = analysed(name).model, analysed(name).pairing
    with refused(expected=expected):
        design_glover_mcfarlane(*given, precompensator=precompensator(*given))


def test_a_precompensator_has_as_many_signals_as_names():
    with refused(expected="one for each input and output"):
        Precompensator("P", SampledSystem(*(np.eye(2) for _ in range(4))), ("a",), ("b",))


def test_a_mode_out_of_reach_is_refused():
    """Two integrators, one of which no input moves."""
    plant = SampledSystem(np.eye(2), np.array([[1.0], [0.0]]), np.ones((1, 2)), np.zeros((1, 1)))
    with pytest.raises(NotApplicable, match="a mode is out of reach"):
        coprime_factors(plant)


def test_a_precompensator_that_cannot_be_inverted_is_told_by_its_own_observer():
    """Pure integral action: nothing acts at once, so W₁ has no inverse."""
    analysis = analysed("three-tanks")
    model, pairing = analysis.model, analysis.pairing
    period = analysis.operating_point.process.sampling_period
    simc = design_simc(model, pairing)
    rate = simc.values["level_3.proportional_gain"] / simc.values["level_3.integral_time"]
    one = np.eye(1)
    system = SampledSystem(one, period * rate * one, one, 0.0 * one)
    shaping = Precompensator("I", system, simc.setpoints, simc.manipulated)
    assert shaping.inverse_direct is None
    controller = design_glover_mcfarlane(model, pairing, precompensator=shaping)
    assert sampled_loop(controller, model).is_stable
    # Told what was applied, its memory dies out by itself.
    assert np.max(np.abs(np.linalg.eigvals(matrices(controller)["transition"]))) < 1.0
    assert np.max(np.abs(np.linalg.eigvals(untold(controller)[0]))) > 1.0 - 1e-9
