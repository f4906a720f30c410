"""What occurs in a laboratory: limits of masses, temperatures and pressures, in columns as in what is known besides."""

from collections.abc import Iterator, Mapping

MAX_MASS = 1e5  # [kg]; weighs 1e6 N, as much as forty arms of the strongest kind carry
MAX_PRESSURE = 1e9  # [Pa]; no cylinder holds it
MIN_PRESSURE = 5e4  # [Pa]; counterbalances hold 2 to 30 MPa, and 30 MPa are 3e4 in kPa
BELOW_ZERO = -5e4  # [Pa] above ambient pressure; zero errors of gauges for such pressures are smaller, and no gas pulls
PRESSURES = "bar? multiply by 100000; MPa? by 1000000"
FILLED = 1e6  # [Pa]; a cylinder that holds so much does not empty and fill again within a run
# [K]; no robot works where it is colder than -50 degrees Celsius, or in air of more than 70. Windings of the best class
# bear 220 degrees Celsius, oil in gears and seals of gas 200 at most.
TEMPERATURES: Mapping[str, tuple[float, float]] = {
    "ambient_temperature": (223.0, 343.0),
    "motor_temperature": (223.0, 523.0),
    "gear_temperature": (223.0, 473.0),
    "gas_temperature": (223.0, 473.0),
}
# Standard deviation of one reading, by the unit of its column: from what double precision keeps of the largest numbers
# to ten times and more what the noisiest instrument has
MIN_NOISE = 1e-12
MAX_NOISE: Mapping[str, float] = {"rad": 1.0, "m": 1.0, "a": 100.0, "n": 1e5, "nm": 1e5, "k": 100.0, "pa": 1e8}
UNITS = {"rad": "rad", "m": "m", "a": "A", "n": "N", "nm": "Nm", "k": "K", "pa": "Pa"}
CELSIUS = 273.15  # [K], of 0 degrees Celsius


def noise_faults(noise: Mapping[str, float], units: Mapping[str, str]) -> Iterator[tuple[str, str, str]]:
    """Yield quantity, fault and remedy of each standard deviation of one reading that no instrument has.

    Args:
        noise: Quantity -> standard deviation.
        units: Quantity -> its unit, as columns have it.
    """
    for quantity, sigma in noise.items():
        unit = units.get(quantity)
        if unit and not MIN_NOISE <= sigma <= MAX_NOISE[unit]:
            words = f"{sigma:g} is no noise of a reading, which is {MIN_NOISE:g} to {MAX_NOISE[unit]:g} {UNITS[unit]}"
            yield quantity, words, "correct it, or leave it out"


def what_a_temperature_may_be(value: float, limits: tuple[float, float]) -> str:
    """Return advice for a temperature out of its limits [K]: the unit that brings it into them."""
    least, most = limits
    if least <= value + CELSIUS <= most:
        return f"degrees Celsius? add {CELSIUS:g}"
    return "millikelvin? multiply by 0.001" if least <= value / 1000 <= most else "give kelvins, or leave it out"
