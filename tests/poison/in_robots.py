"""Robot folders: their figures, and what a campaign takes for its robot."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from bench import paths
from tests.poison.variant import Answer, Spoil, Variant
from tests.small_robot import write_small_robot

FIGURES = "figures.yaml"
LAUGHS = "".join(f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10 if i else ['x'] * 10)}]\n" for i in range(12))


def _figures(change: str, new: str = "") -> Spoil:
    def spoil(folder: Path) -> None:
        file = folder / "robot" / FIGURES
        text = file.read_text()
        assert change in text, change
        file.write_text(text.replace(change, new, 1))

    return spoil


def _append(line: str) -> Spoil:
    def spoil(folder: Path) -> None:
        file = folder / "robot" / FIGURES
        file.write_text(file.read_text() + line)

    return spoil


def rotors_before_their_gears(rng: np.random.Generator) -> Iterator[Variant]:
    """Give a rotor's inertia as it is in the motor, for the one at the joint."""
    for name, given in (("hinge_a", "40.0"), ("hinge_b", "20.0")):

        def spoil(folder: Path, given: str = given) -> None:
            file = folder / "robot" / "small.xml"
            text = file.read_text()
            assert f'armature="{given}"' in text
            file.write_text(text.replace(f'armature="{given}"', f'armature="{float(given) / 1e4:g}"'))

        words = (name, "gives its rotor is", "square of the gear ratio")
        yield Variant("rotors before their gears", name, spoil, "harmless", words)


def figures(rng: np.random.Generator) -> Iterator[Variant]:
    appended: dict[str, tuple[str, tuple[str, ...]]] = {
        "a key given twice": ("title: other\n", ("title", "twice")),
        "an unknown key": ("colour: red\n", ("colour",)),
        "a thousand million laughs": (LAUGHS, ("BENCH_MOST_YAML_VALUES",)),
        "brackets": (f"x: {'[' * 50_000}\n", ("BENCH_MOST_YAML_DEPTH",)),
        "an alias in itself": ("x: &a [*a]\n", ("alias",)),
        "a long number": (f"x: {'9' * 20_000}\n", ("characters",)),
        "a date that is none": ("x: 2024-99-99\n", ("month",)),
        "code": ("x: !!python/object/apply:os.system [id]\n", ("python/object",)),
        "a word as a time": ("x: !!timestamp soon\n", ("'soon' is no !!timestamp",)),
        "a word as a truth": ("x: !!bool perhaps\n", ("'perhaps' is no !!bool",)),
        "nothing as a number": ("x: !!int ''\n", ("'' is no !!int",)),
        "half a pair": ('x: "\\udc00"\n', ("surrogate",)),
        "an uncertainty below zero": ("uncertainty: {mass: -1}\n", ("uncertainty.mass",)),
        "an uncertainty of nan": ("uncertainty: {mass: .nan}\n", ("uncertainty.mass",)),
        "an uncertainty for too few drives": ("uncertainty: {friction: [0.1]}\n", ("uncertainty.friction", "2 drives")),
        "a rotor below zero": ("uncertainty: {rotor_inertia: [0.1, -1]}\n", ("uncertainty.rotor_inertia[1]",)),
        "a stiffness in words": ("uncertainty: {stiffness: [soft, 3]}\n", ("uncertainty.stiffness[0]",)),
        "a list for a section": ("uncertainty: [1]\n", ("uncertainty",)),
        "an uncertainty of 1e9": ("uncertainty: {mass: 1.0e+9}\n", ("uncertainty.mass",)),
        "a weight below zero": ("fitted: {weights: {hung: -5}}\n", ("fitted.weights.hung",)),
        "a scene that is not there": ("scene: nowhere.xml\n", ("scene", "nowhere.xml")),
        "an assumption that steers the terminal": ('assumed: ["\\x1b[31m"]\n', ("assumed[0]",)),
        "a scene that is no MJCF": ("scene: figures.yaml\n", ("scene",)),
    }
    for name, (line, places) in appended.items():
        yield Variant("figures", name, _append(line), "error", (f"robot/{FIGURES}", *places))
    remarked: dict[str, tuple[Spoil, tuple[str, ...]]] = {
        "a mass 500 % uncertain": (_append("uncertainty: {mass: 5}\n"), ("uncertainty.mass", "per cent?")),
        "friction of a drive 500 % uncertain": (
            _append("uncertainty: {friction: [0.1, 5]}\n"),
            ("uncertainty.friction[1]", "per cent?"),
        ),
        "noise beyond the drives": (_figures("sigma_a: 0.02", "sigma_a: 99"), ("sigma_a", "than a drive has")),
        "an encoder 4 s late": (_figures("encoder: {}", "encoder: {delay_s: 4}"), ("delay_s", "milliseconds?")),
    }
    for name, (spoil, places) in remarked.items():
        yield Variant("figures", name, spoil, "error or harmless", (f"robot/{FIGURES}", *places))
    speed = "speed_limit_rad_per_s"
    changed: dict[str, tuple[str, str, tuple[str, ...]]] = {
        "a word for a number": (f"{speed}: 2.0", f"{speed}: fast", (speed,)),
        "infinite speed": (f"{speed}: 2.0", f"{speed}: .inf", (speed,)),
        "a speed of zero": (f"{speed}: 2.0", f"{speed}: 0", (speed,)),
        "no joint": ("joint: hinge_b", "join: hinge_b", ("drives[1]",)),
        "an MJCF that is not there": ("mjcf: small.xml", "mjcf: other.xml", ("other.xml",)),
        "an MJCF that is a device": ("mjcf: small.xml", "mjcf: /dev/zero", ("/dev/zero",)),
        "an MJCF with a zero byte": ("mjcf: small.xml", 'mjcf: "a\\0b"', ("mjcf",)),
        "a servo of another name": ("servo: servo_a", "servo: motor_a", ("drives[0].servo", "motor_a")),
        "one joint twice": ("joint: hinge_b", "joint: hinge_a", ("drives[1]",)),
        "a reflector that is not there": ("- nest_1", "- nest_9", ("reflectors[0]", "nest_9")),
        "a piston of no area": ("piston_area_m2: 0.001", "piston_area_m2: 0", ("piston_area_m2",)),
        "a counterbalance that is an elastic element": (
            "  actuator: balance\n  joint: hinge_a\n  tendon: balance",
            "  actuator: servo_a\n  joint: hinge_a\n  tendon: element_a",
            ("counterbalance.tendon", "'element_a'", "counterbalance.actuator", "'servo_a'"),
        ),
        "a counterbalance that acts on another tendon": (
            "  actuator: balance\n", "  actuator: servo_a\n", ("counterbalance.actuator", "'servo_a'"),
        ),
    }  # fmt: skip
    changed["a title of two lines"] = ("title: two-joint test robot", 'title: "a\\nb"', ("title",))
    for constant in ("1.0e-12", "-100"):
        key = "torque_constant_nm_per_a"
        changed[f"{key} of {constant}"] = (f"{key}: 100.0", f"{key}: {constant}", (f"drives[0].{key}",))
    for key, value in (("delay_s", "1.0e+9"), ("resolution_rad", "10")):
        changed[f"{key} of {value}"] = ("encoder: {}", f"encoder: {{{key}: {value}}}", (f"encoder.{key}",))
    changed["a gain of 1e9"] = ("force: {}", "force: {gain_sigma: 1.0e+9}", ("force.gain_sigma",))
    for name, (old, new, places) in changed.items():
        yield Variant("figures", name, _figures(old, new), "error", places)


def robots_of_strangers(rng: np.random.Generator) -> Iterator[Variant]:
    """Name in `robot:` of a campaign what is none, or another."""
    names: dict[str, tuple[str, Answer]] = {
        "nowhere": ("nowhere", "error"),
        "a file": ("runs/dwell.csv", "error"),
        "a device": ("/dev/zero", "error"),
        "a long name": ("x" * 5000, "error"),
        "a folder without figures": ("runs", "error"),
        "a loop": ("loop", "error"),
        "a zero byte": ('"a\\0b"', "error"),
        "another robot": ("emps", "error"),
        "a robot with more drives": ("hh150", "error or harmless"),
        "a link to the robot": ("link", "harmless"),
    }
    for name, (written, answer) in names.items():

        def spoil(folder: Path, written: str = written) -> None:
            file = folder / "campaign.yaml"
            file.write_text(file.read_text().replace("robot: robot", f"robot: {written}"))
            (folder / "loop").symlink_to("loop")
            (folder / "link").symlink_to("robot")

        places = ("campaign.yaml: robot: unknown robot",) if answer == "error" and written != "emps" else ()
        yield Variant("robots of strangers", name, spoil, answer, places)

    def twin(folder: Path) -> None:
        write_small_robot(folder / "hh150")
        file = folder / "campaign.yaml"
        file.write_text(file.read_text().replace("robot: robot", "robot: hh150"))

    yield Variant("robots of strangers", "a folder with the name of a known robot", twin, "harmless")


def numbers_of_yaml(rng: np.random.Generator) -> Iterator[Variant]:
    """Write numbers as YAML 1.1 reads them and people do not; one at a place of figures, one of a scenario."""
    sound = (paths.scenarios_dir() / "loading.yaml").read_text()
    for value in ("0x10", "010", "1_000", "1:30", "0b11", "true", "yes"):
        place = "figures.yaml: drives[0].speed" if value.isalpha() else f"'{value}' is no decimal number"
        spoil = _figures("speed_limit_rad_per_s: 2.0", f"speed_limit_rad_per_s: {value}")
        yield Variant("numbers of YAML", f"{value} in figures", spoil, "error", (f"robot/{FIGURES}", place))
        place = "repeats" if value.isalpha() else f"'{value}' is no decimal number"

        def write(folder: Path, value: str = value) -> None:
            (folder / "mine.yaml").write_text(sound.replace("repeats: 10", f"repeats: {value}"))

        command = ("run", "mine.yaml", "-o", "out")
        yield Variant("numbers of YAML", f"{value} in a scenario", write, "error", ("mine.yaml", place), command)


def noise_of_instruments(rng: np.random.Generator) -> Iterator[Variant]:
    """State what no instrument has; what counts for nothing, or for everything, was believed."""
    changes = {
        "sigma_a": ("sigma_a: 0.02", ("1.0e+5", "-1", "1.0e-300", ".inf")),
        "resolution_rad": ("encoder: {}", ("1.0e-200", "0")),
        "sigma_n": ("force: {}", ("1.0e+6", "1.0e-200")),
        "piston_area_m2": ("piston_area_m2: 0.001", ("1.0e-30",)),
    }
    for key, (old, values) in changes.items():
        for value in values:
            new = f"{old[:-2]}{{{key}: {value}}}" if old.endswith("{}") else f"{key}: {value}"
            yield Variant("noise of instruments", f"{key} of {value}", _figures(old, new), "error", (FIGURES, key))
    for line in ("current: 1e6", "current: 1e-13", "reflector: 30", "gas_pressure: 1e9"):

        def append(folder: Path, line: str = line) -> None:
            file = folder / "campaign.yaml"
            file.write_text(f"{file.read_text()}noise: {{{line}}}\n")

        place = f"campaign.yaml: noise.{line.split(':')[0]}"
        yield Variant("noise of instruments", line, append, "error", (place,))


def noise_that_a_robot_states(rng: np.random.Generator) -> Iterator[Variant]:
    """State noise in milli; a current that scatters by 20 A tells nothing of any drive, and nothing was said."""
    for key, old, new in (
        ("current.sigma_a", "sigma_a: 0.02", "sigma_a: 20"),
        ("force.sigma_n", "force: {}", "force: {sigma_n: 500}"),
        ("force.sigma_nm", "force: {}", "force: {sigma_nm: 200}"),
    ):
        words = (f"instruments.{key}", "times as much as its readings scatter")
        yield Variant("noise that a robot states", new, _figures(old, new), "harmless", words)


def errors_as_fitted(rng: np.random.Generator) -> Iterator[Variant]:
    """State as fitted what no instrument errs by; each was believed."""
    for key, value in (
        ("current_gain", "{hinge_a: -3}"),
        ("current_gain", "{hinge_a: 1.0e+9}"),
        ("current_offset_a", "{hinge_b: 1.0e+9}"),
        ("tracker_shift_m", "[1.0e+9, 0, 0]"),
        ("tracker_turn_rad", "[0, 60, 0]"),
        ("force_gain", "-5"),
        ("force_tilt_rad", "[9, 9, 9]"),
        ("gas_thermometer_k", "1.0e+5"),
    ):
        spoil = _append(f"fitted: {{readings: {{{key}: {value}}}}}\n")
        place = (f"robot/{FIGURES}", f"fitted.readings.{key}")
        yield Variant("errors as fitted", f"{key}: {value}", spoil, "error", place)


FAMILIES = (
    rotors_before_their_gears,
    figures,
    robots_of_strangers,
    numbers_of_yaml,
    noise_of_instruments,
    noise_that_a_robot_states,
    errors_as_fitted,
)
