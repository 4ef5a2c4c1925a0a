"""Functions as data: values and derivatives beside sympy, the language of formulas, what it refuses."""

from __future__ import annotations

import copy
import math
import pickle
import time
from typing import Any

import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

import mbd
from mbd.functions import KINDS
from mbd.functions.language import DEEPEST, LONGEST, number, parse
from mbd.functions.translation import FUNCTIONS

T = np.array([0.05, 0.31, 0.77])
FORMULAS = [
    "2 * sin(3 * t) - cos(t)**3 / (1 + t)",
    "exp(-t) * tan(t / 2) + log(1 + t**2) * sqrt(t) - log10(t + 2) * t",
    "asin(t / 2) + acos(t / 3) - atan(4 * t) + atan2(1 + t, 2 - t**2)",
    "sinh(t) * cosh(2 * t) - tanh(3 * t) ** 2",
    "t ** 2.5 + 2 ** t + t ** t + (1 + t) ** -2 - -t ** 2",
    "pi * t + e ** (2 * t) + tau / (t + 1)",
    "t ** 0 + t ** 1 + 3 * t ** 2 + +t",
]


@pytest.mark.parametrize("text", FORMULAS)
def test_formulas_and_their_derivatives_agree_with_sympy(text: str) -> None:
    symbol = sympy.Symbol("t")
    names = {"log10": lambda x: sympy.log(x, 10), "t": symbol, "pi": sympy.pi, "e": sympy.E, "tau": 2 * sympy.pi}
    exact = sympy.sympify(text, locals=names)
    found = mbd.Expression(text)
    for order, function in enumerate((found, found.rate, found.acceleration)):
        expected = [float(exact.diff(symbol, order).subs(symbol, x).evalf(30)) for x in T]
        np.testing.assert_allclose([function(x) for x in T], expected, rtol=2e-14, atol=1e-13)


def test_laws_have_exact_gradients_and_hessians() -> None:
    x, y = sympy.symbols("x y")
    exact = sympy.exp(x * y) / sympy.sqrt(y) + x**3 * y
    found = mbd.Expression(["exp(x * y) / sqrt(y) + x**3 * y", "t * x"], ("t", "x", "y"))
    at = {x: 0.7, y: 1.9}
    gradient = [float(exact.diff(s).subs(at)) for s in (x, y)]
    hessian = [[float(exact.diff(a, b).subs(at)) for b in (x, y)] for a in (x, y)]
    np.testing.assert_allclose(found.gradient(3.0, 0.7, 1.9), [gradient, [3.0, 0.0]], rtol=1e-14)
    np.testing.assert_allclose(found.hessian(3.0, 0.7, 1.9), [hessian, np.zeros((2, 2))], rtol=1e-13)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("min(3, 2, 5) + max(1, 2)", 4.0),
        ("abs(-2) + sign(-3) + floor(2.7) + ceil(2.2) + round(2.6)", 9.0),
        ("1 if 2 < 3 <= 3 else 5", 1.0),
        ("1 if not 2 > 3 and (1 >= 2 or 4 > 3) else 5", 1.0),
        (" 2**3**2 ", 512.0),
        ("-2**2", -4.0),
    ],
)
def test_arithmetic_is_pythons(text: str, value: float) -> None:
    assert number(text) == value


def test_kinks_are_found_where_t_is_compared_with_a_number() -> None:
    brake = mbd.Expression("2 * k if t > 0.4 and not t > off else min(t, 0.25)", constants={"k": 1.5, "off": 0.6}, discontinuities=[0.5])
    assert brake.discontinuities == (0.25, 0.4, 0.5, 0.6)
    assert (brake(0.1), brake(0.3), brake(0.5), brake(0.7)) == (0.1, 0.25, 3.0, 0.25)
    assert (brake.rate(0.1), brake.rate(0.3)) == (1.0, 0.0)
    assert mbd.Expression("1 if sin(t) > 0 else 0").discontinuities == ()


REFUSED = {
    "__import__('os').system('id')": "expected a function among",
    "x.real": "found 'x.real'",
    "sni(t)": "did you mean 'sin'",
    "2 ^ 3": r"write a power as \*\*",
    "1 if t else 2": "expected a condition",
    "1 if t == 2 else 3": "expected a condition",
    "(t < 1) * 3": "stands in 'a if t < 1 else b' only",
    "'a'": "expected a number, found",
    "True": "expected a number",
    "1j": "expected a number",
    "1e999": "below 1e308",
    "9" * 400: "below 1e308",
    "lambda: 1": "found 'lambda: 1'",
    "[t for t in (1, 2)]": "expected numbers, names",
    "sin(t, 2)": "sin: expected 1 number",
    "sin(x=t)": "sin: expected 1 number",
    "max(t)": "two or more",
    "min(*t)": "two or more",
    "atan2(1, 2, 3)": "two or more numbers|2 numbers",
    "(t := 3)": "found '\\(t := 3\\)'",
    "t if": "expected a formula such as",
    "": "expected a formula such as",
    "\0": "expected a formula such as",
    "t // 2": "found 't // 2'",
    "t % 2": "found 't % 2'",
    "~t": "expected \\+ - \\* / or \\*\\*",
    "u + 1": "expected one of t, pi, e, tau; found 'u'",
    "(" * 300 + "t" + ")" * 300: "expected a formula such as",
    "-" * 900 + "t": f"at most {DEEPEST} operations",
    "+1" * (LONGEST // 2 + 1): f"at most {LONGEST} characters",
    "f'{t}'": "expected a number|expected numbers",
}


@pytest.mark.parametrize("text", REFUSED, ids=lambda text: text[:20].replace("\0", "null"))
def test_other_texts_are_refused_in_words(text: str) -> None:
    clock = time.process_time()
    with pytest.raises(ValueError, match=REFUSED[text]) as trouble:
        mbd.Expression(text)
    assert time.process_time() - clock < 0.5 and len(str(trouble.value)) < 500


@pytest.mark.parametrize("text", ["9**9**9", "1 / (t - t)", "(t - 2)**0.5", "log(-1)", "exp(1000)", "1e300 * 1e300", "0 * (1e300 * 1e300)"])
def test_no_value_is_an_error_not_a_nan(text: str) -> None:
    with pytest.raises(ValueError, match="expected a finite value"):
        mbd.Expression(text)(1.0)
    with pytest.raises(ValueError, match="expected a finite value"):
        mbd.Expression(f"t * ({text})").rate(1.0)


LEAVES = st.sampled_from(["t", "1.0", "2.5", "pi", "k", "0.0"])


def _operations(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    pairs = st.tuples(inner, st.sampled_from(["+", "-", "*", "/", "**"]), inner).map(lambda x: f"({x[0]} {x[1]} {x[2]})")
    single = st.sampled_from([name for name in FUNCTIONS if name not in ("min", "max", "atan2", "sign")])
    calls = st.tuples(single, inner).map(lambda x: f"{x[0]}({x[1]})")
    several = st.tuples(st.sampled_from(("min", "max", "atan2")), inner, inner).map(lambda x: f"{x[0]}({x[1]}, {x[2]})")
    choices = st.tuples(inner, inner, inner).map(lambda x: f"({x[0]} if {x[1]} < {x[2]} else -{x[0]})")
    return pairs | calls | several | choices


@settings(max_examples=100, deadline=None)
@given(st.recursive(LEAVES, _operations, max_leaves=12), st.floats(-3, 3))
def test_values_are_pythons_own(text: str, t: float) -> None:
    """Beside Python's interpreter, on texts made by the test."""
    names = {name: getattr(math, name, None) or {"abs": abs, "round": round, "min": min, "max": max}.get(name) for name in FUNCTIONS}
    try:
        expected = eval(text, {"__builtins__": {}}, names | {"t": t, "k": 3.0, "pi": math.pi})
        expected = float(expected) if math.isfinite(expected) else None
    except (ArithmeticError, ValueError, TypeError):
        expected = None
    try:
        assert mbd.Expression(text, constants={"k": 3.0})(t) == pytest.approx(expected, rel=1e-12)
    except ValueError:
        assert expected is None


@settings(max_examples=200, deadline=None)
@given(st.lists(st.sampled_from([*"t12.+-*/()<>= ,'\"[]{}:@_x\\\n#e", "sin", "max(", " if ", " else ", "lambda ", "__class__"]), max_size=40))
def test_any_text_is_a_formula_or_refused(parts: list[str]) -> None:
    try:
        value = parse("".join(parts), ("t",)).closure((0.5,))
    except (ValueError, ArithmeticError):
        return
    assert isinstance(value, float)


MADE: dict[str, Any] = {
    "Expression": mbd.Expression("a * t**2 if t < 0.5 else 0.25 * a", constants={"a": 2.0}, discontinuities=[0.7]),
    "Sine": mbd.Sine(2.0, 1.5, phase=0.3, offset=0.1),
    "Sine of a vector": mbd.Sine((2.0, 0.0, 1.0), 1.5, offset=(0.0, 1.0, 0.0)),
    "Ramp": mbd.Ramp(0.2, 0.6, before=-1.0, after=3.0),
    "SmoothStep": mbd.SmoothStep(0.2, 0.6, after=(3.0, 1.0)),
    "Table": mbd.Table([0.0, 0.3, 1.0], [0.0, 1.0, -1.0]),
    "Spline": mbd.Spline([0.0, 0.3, 0.6, 1.0], [(0.0, 1.0), (1.0, 0.0), (-1.0, 0.0), (2.0, 0.0)]),
    "Motion": mbd.Motion(mbd.Sine(1.0, 2.0), rate=mbd.Expression("4 * pi * cos(4 * pi * t)")),
    "Piecewise": mbd.piecewise(mbd.Sine(1.0, 2.0), at=[0.4]),
}
SAMPLES = [0.1, 0.25, 0.4, 0.8]


def test_every_kind_is_tested() -> None:
    assert {type(function).__name__ for function in MADE.values()} == set(KINDS)


@pytest.mark.parametrize("name", MADE)
def test_functions_survive_pickling_and_copying(name: str) -> None:
    function = MADE[name]
    for other in (pickle.loads(pickle.dumps(function)), copy.deepcopy(function)):
        assert type(other) is type(function)
        assert all(np.array_equal(function(t), other(t)) for t in SAMPLES)
        assert getattr(other, "discontinuities", None) == getattr(function, "discontinuities", None)


@pytest.mark.parametrize("name", [name for name in MADE if name not in ("Motion", "Piecewise")])
def test_rates_and_accelerations_are_those_of_the_values(name: str) -> None:
    """By differences of high order, away from kinks; splines are cubic there."""
    function, h = MADE[name], 1e-3
    weights = np.array([-1 / 60, 3 / 20, -3 / 4, 0, 3 / 4, -3 / 20, 1 / 60]) / h
    for lower, upper in ((function, function.rate), (function.rate, function.acceleration)):
        for t in SAMPLES:
            by_differences = sum(w * np.asarray(lower(t + k * h)) for w, k in zip(weights, range(-3, 4)))
            np.testing.assert_allclose(upper(t), by_differences, rtol=1e-8, atol=1e-8)


def test_shapes_at_their_ends() -> None:
    ramp, step = MADE["Ramp"], mbd.SmoothStep(0.2, 0.6, before=-1.0, after=3.0)
    for function in (ramp, step):
        assert (function(0.0), function(0.2), function(0.4), function(0.6), function(9.0)) == pytest.approx((-1, -1, 1, 3, 3))
        assert function.discontinuities == (0.2, 0.6)
    assert ramp.rate(0.3) == pytest.approx(10.0) and (step.rate(0.2), step.acceleration(0.6)) == (0.0, 0.0)
    assert MADE["Table"](0.15) == pytest.approx(0.5) and MADE["Table"].discontinuities == (0.0, 0.3, 1.0)
    assert MADE["Spline"](0.3) == pytest.approx([1.0, 0.0]) and MADE["Spline"].discontinuities == ()
    with pytest.raises(ValueError, match=r"t = 1.1 s is outside of the table, which goes from 0 to 1 s"):
        MADE["Table"](1.1)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: mbd.Sine("a", 1.0), "Sine: amplitude: expected finite numbers"),
        (lambda: mbd.Sine(1.0, np.inf), "Sine: frequency: expected a number"),
        (lambda: mbd.Ramp(1.0, 1.0), "Ramp: end: expected a time after the start"),
        (lambda: mbd.Table([0.0, 0.0], [1.0, 2.0]), "Table: times: expected two or more ascending"),
        (lambda: mbd.Spline([0.0, 1.0], [1.0]), "Spline: values: expected one for each of the 2 times"),
        (lambda: mbd.Expression(3), "Expression: text: expected a formula"),
        (lambda: mbd.Expression("t", ("t", "t")), "variables, constants: expected names, each once"),
        (lambda: mbd.Expression("t", constants={"sin": 1.0}), "variables, constants: expected names"),
    ],
)
def test_wrong_numbers_are_refused(make: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()


def test_a_motor_follows_a_formula_exactly() -> None:
    """Its rate and acceleration are exact: the torque of a driven wheel is J phi'' to rounding."""
    scene = mbd.Scene(gravity=(0.0, 0.0))
    wheel = scene.add(mbd.RigidBody(mass=1.0, inertia=0.5, position=(0, 0)))
    scene.add(mbd.Pin(wheel.at(), scene.ground.at()))
    motor = scene.add(mbd.Motor(wheel, scene.ground, angle=mbd.Expression("0.3 * sin(4 * t)")))
    result = mbd.simulate(scene, 1.0, t_eval=[0.2, 0.5, 0.9])
    np.testing.assert_allclose(result.angle(wheel), 0.3 * np.sin(4 * result.t), atol=1e-12)
    np.testing.assert_allclose(result.reaction(motor)[:, 2], -0.5 * 0.3 * 16 * np.sin(4 * result.t), rtol=1e-10)


def test_laws_bring_their_derivatives_along() -> None:
    """A formula's own gradient is used, so that nothing is differenced: as if it had been given."""
    scene = mbd.Scene(gravity=(0.0, -9.81))
    ball = scene.add(mbd.Particle(1.0, (1.0, 0.0)))
    length = scene.add(mbd.Length(ball, scene.ground.at()))
    law = mbd.Expression("-k * (s - 1)**3 - c * ds", ("t", "s", "ds"), {"k": 500.0, "c": 0.3})
    scene.add(mbd.ForceLaw(length, law, rates=True))
    other = mbd.Scene(gravity=(0.0, -9.81))
    twin = other.add(mbd.Particle(1.0, (1.0, 0.0)))
    other.add(mbd.ForceLaw(other.add(mbd.Length(twin, other.ground.at())), lambda t, s, ds: -500 * (s - 1) ** 3 - 0.3 * ds, rates=True))
    results = [mbd.simulate(s, 1.0, rtol=1e-10, solver=mbd.Radau()) for s in (scene, other)]
    np.testing.assert_allclose(results[0].position(ball.at())[-1], results[1].position(twin.at())[-1], atol=1e-9)
