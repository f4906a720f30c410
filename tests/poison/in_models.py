"""MJCF of robots: what crashes its reader, attributes of the plugins, numbers and laws that no robot has."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from bench.robot.switches import NEEDED
from tests.poison.variant import Answer, Spoil, Variant
from tests.small_robot import MJCF, ROTOR

ARM = "small.xml"


def _mjcf(old: str, new: str, count: int = 1) -> Spoil:
    assert old in MJCF

    def spoil(folder: Path) -> None:
        (folder / "robot" / ARM).write_text(MJCF.replace(old, new, count))

    return spoil


def _in_world(text: str) -> Spoil:
    return _mjcf("<worldbody>", f"<worldbody>{text}")


def _before(text: str) -> Spoil:
    return _mjcf("<worldbody>", f"{text}<worldbody>")


def _keyframe(qpos: str) -> Spoil:
    return _mjcf("</mujoco>", f'<keyframe><key qpos="{qpos}"/></keyframe></mujoco>')


def mjcf_that_crashes_its_reader(rng: np.random.Generator) -> Iterator[Variant]:
    def chain(folder: Path) -> None:
        _before('<include file="0.xml"/>')(folder)
        for i in range(3000):
            (folder / "robot" / f"{i}.xml").write_text(f'<mujoco><include file="{i + 1}.xml"/></mujoco>')

    laughs = "".join(f'<!ENTITY a{i} "{f"&a{i - 1};" * 10 if i else "x" * 10}">' for i in range(12))
    table = (
        '<plugin name="drag" joint="hinge_a" plugin="bench.torque_table"><config key="angle_min" value="0"/>'
        '<config key="angle_max" value="1e-310"/><config key="forward" value="1 2"/>'
        '<config key="backward" value="1 2"/></plugin></actuator>'
    )

    def no_width(folder: Path) -> None:
        text = MJCF.replace("<extension>", '<extension><plugin plugin="bench.torque_table"/>')
        (folder / "robot" / ARM).write_text(text.replace("</actuator>", table))

    wide = '<replicate count="100000">' * 2 + '<geom size="1"/>' + "</replicate>" * 2
    keyframe = '<keyframe><key qpos="0 nan 0 0"/></keyframe></mujoco>'
    crashes: dict[str, tuple[Spoil, str]] = {
        "3000 includes in each other": (chain, "BENCH_MOST_MODEL_INCLUDES"),
        "a file that includes itself": (_before(f'<include file="{ARM}"/>'), ""),
        "ten thousand million copies": (_in_world(wide), "BENCH_MOST_MODEL_COPIES"),
        "5000 bodies in each other": (_in_world("<body>" * 5000 + "</body>" * 5000), "BENCH_MOST_MODEL_DEPTH"),
        "5000 frames in each other": (_in_world("<frame>" * 5000 + "</frame>" * 5000), "BENCH_MOST_MODEL_DEPTH"),
        "entities": (_mjcf("<mujoco", f"<!DOCTYPE a [{laughs}]><mujoco"), "line 2"),
        "an entity of another file": (_mjcf("<mujoco", '<!DOCTYPE a SYSTEM "/etc/passwd"><mujoco'), "line 2"),
        "a keyframe of nan": (_mjcf("</mujoco>", keyframe), "<key>: qpos"),
        "a place of nan": (_mjcf('pos="-0.02 0 -0.5"', 'pos="nan 0 0"'), "<site>: pos"),
        "a place of inf": (_mjcf('<body name="upper">', '<body name="upper" pos="inf 0 0">'), "<body>: pos holds inf"),
        "a table of no width": (no_width, "angle_max"),
        "16 GB of user data": (_before('<size nuserdata="2000000000"/>'), ""),
        "a height field of 10^10": (
            _before('<asset><hfield name="h" nrow="100000" ncol="100000" size="1 1 1 1"/></asset>'), ""
        ),
        "a texture of 10^10": (
            _before('<asset><texture name="t" type="2d" builtin="flat" width="100000" height="100000"/></asset>'), ""
        ),
        "a mesh of a device": (_before('<asset><mesh name="m" file="/dev/zero"/></asset>'), "is a device"),
        "a mesh of a folder": (_before('<asset><mesh name="m" file="/etc"/></asset>'), "is a folder"),
        "a mesh of text": (_before('<asset><mesh name="m" file="/etc/passwd"/></asset>'), ""),
        "a plugin that is not there": (_mjcf("bench.friction", "evil.so"), ""),
        "an empty file": (lambda folder: (folder / "robot" / ARM).write_text("").__str__() and None, "not XML"),
        "zeros": (lambda folder: (folder / "robot" / ARM).write_bytes(bytes(1000)).__str__() and None, "not XML"),
    }  # fmt: skip
    for name, (spoil, place) in crashes.items():
        yield Variant("MJCF that crashes its reader", name, spoil, "error", ("robot", place))


def damaged_mjcf(rng: np.random.Generator) -> Iterator[Variant]:
    data = MJCF.encode()
    for _ in range(12):
        at, byte = int(rng.integers(len(data))), bytes([rng.integers(1, 256)])

        def spoil(folder: Path, at: int = at, byte: bytes = byte) -> None:
            (folder / "robot" / ARM).write_bytes(data[:at] + byte + data[at + 1 :])

        yield Variant("damaged MJCF", f"byte {at} is {byte!r}", spoil, "error or harmless")
    for share in rng.random(6).tolist():

        def cut(folder: Path, share: float = share) -> None:
            (folder / "robot" / ARM).write_bytes(data[: int(share * len(data))])

        yield Variant("damaged MJCF", f"{share:.1%} left", cut, "error", (ARM,))


def attributes_of_plugins(rng: np.random.Generator) -> Iterator[Variant]:
    values = ("nan", "inf", "-1", "1e999", "word", "1 2 3", "é" * 50, "1,5", "0x", "-0.0001", "1" * 5000 + "e")
    for value in values:
        for key, given in (("coulomb", "60.0"), ("critical_length", "0.65")):
            spoil = _mjcf(f'key="{key}" value="{given}"', f'key="{key}" value="{value}"')
            place = "<config>: value" if value in ("nan", "inf") else key
            yield Variant("attributes of plugins", f"{key} = {value[:12]}", spoil, "error", (place,))
    unknown = _mjcf('key="coulomb"', 'key="colombo"')
    yield Variant("attributes of plugins", "an unknown one", unknown, "error", ("colombo",))


def parts_of_robots(rng: np.random.Generator) -> Iterator[Variant]:
    changes: dict[str, tuple[str, str, tuple[str, ...]]] = {
        "no armature": ('armature="40.0"', "", ("drives[0].rotor",)),
        "no stiffness": ('stiffness="200000.0"', 'stiffness="0"', ("drives[0].element",)),
        "a negative mass": ('mass="40.0"', 'mass="-40"', ("upper",)),
        "an inertia that cannot be": ('diaginertia="2.2 2.1 0.2"', 'diaginertia="9 1 1"', ("upper",)),
        "a joint of another name": ('name="hinge_a"', 'name="elbow"', ("hinge_a",)),
        "a ball joint": (
            '<joint name="hinge_a" axis="0 1 0" range="-1 2"/>',
            '<joint name="hinge_a" type="ball"/>',
            (),
        ),
        "no load body": ('<body name="load"', '<body name="other"', ("load",)),
        "no load point": ('<site name="hook"', '<site name="other"', ("hook",)),
    }
    for name, (old, new, places) in changes.items():
        yield Variant("parts of robots", name, _mjcf(old, new), "error", places)


def numbers_of_no_robot(rng: np.random.Generator) -> Iterator[Variant]:
    """Write into the MJCF what compiles and is no robot: lost signs, other units, slips of the keyboard."""
    family, kp, limit = "numbers of no robot", f'kp="{ROTOR[0] * 3600}"', 'forcerange="-9000 9000"'
    stiffness, joint, fore = (
        'stiffness="200000.0"',
        'name="hinge_a" axis="0 1 0" range="-1 2"',
        '<body name="fore" pos="0 0 0.8">',
    )
    changes: dict[str, tuple[str, str, str]] = {
        **{f"a time step of {x}": ('timestep="0.001"', f'timestep="{x}"', "timestep is") for x in (0, -1, 1, 1e-12)},
        **{f"a servo's kp of {x}": (kp, f'kp="{x}"', "'servo_a': kp is") for x in (0, -7630, 1e15)},
        "a servo's kv below zero": (f'kv="{ROTOR[0] * 120}"', 'kv="-1"', "kv cannot be negative"),
        **{
            f"a forcerange of {x}": (limit, f'forcerange="{x}"', "'servo_a': forcerange is")
            for x in ("300 -300", "100 300", "0 0", "-2e8 2e8")
        },
        "a centre of mass in millimetres": ('pos="0.35 0 0" mass', 'pos="350 0 0" mass', "distance of its centre"),
        "a radius of gyration of 5 m": ('diaginertia="0.12 1.1 1.0"', 'diaginertia="600 600 600"', "largest radius"),
        "no forcerange": (limit, "", "'servo_a': forcerange is"),
        "degrees taken for radians": (joint, joint.replace("-1 2", "-150 150"), 'compiler angle="radian"'),
        "a zero that is moved": (joint, f'{joint} ref="0.5"', "'hinge_a' has ref != 0"),
        "no range": (joint, joint.removesuffix(' range="-1 2"'), "'hinge_a' has no range"),
        **{f"a mass of {x:g}": ('mass="40.0"', f'mass="{x}"', "'upper': mass is") for x in (12000, 1e12, 1e300)},
        "an element of 3 Nm/rad": (stiffness, 'stiffness="3"', "'element_a': the frequency"),
        "an element of 1e15 Nm/rad": (stiffness, 'stiffness="1e15"', "'element_a': stiffness is"),
        "an element that drives": ('damping="400.0"', 'damping="-400"', "'element_a': damping is"),
        **{f"an armature of {x:g}": ('armature="40.0"', f'armature="{x}"', "armature is") for x in (1e30, -2)},
        "friction that drives": (joint, f'{joint} damping="-1"', "'hinge_a': damping is"),
        "millimetres for metres": (fore, fore.replace("0.8", "800"), "'fore': distance"),
        "gravity in mm/s^2": ('timestep="0.001"', 'timestep="0.001" gravity="0 0 -9810"', "gravity is"),
    }  # fmt: skip
    for name, (old, new, place) in changes.items():
        yield Variant(family, name, _mjcf(old, new), "error", (place,))


def laws_switched_off(rng: np.random.Generator) -> Iterator[Variant]:
    """Take from the robot what no machine can be without: it compiles, and was believed."""
    option = 'timestep="0.001"/>'
    changes: dict[str, tuple[Spoil, str]] = {
        name: (_mjcf(option, f'timestep="0.001"><flag {name}="disable"/></option>'), f"<flag>: {name} is off")
        for name in NEEDED
    }
    changes |= {
        "drives of a group": (_mjcf(option, f'actuatorgroupdisable="0" {option}'), "actuatorgroupdisable"),
        "the weight of a link": (_mjcf('<body name="fore"', '<body gravcomp="1" name="fore"'), "'fore': gravcomp"),
        "all masses": (_mjcf('<compiler angle="radian"', '<compiler settotalmass="1" angle="radian"'), "settotalmass"),
        "air, for water": (_mjcf(option, f'density="1000" {option}'), "density of what flows around it is"),
        "air, for oil": (_mjcf(option, f'viscosity="0.1" {option}'), "viscosity of what flows around it is"),
    }
    for name, (spoil, place) in changes.items():
        yield Variant("laws that are switched off", name, spoil, "error", (f"robot/{ARM}", place))
    contact = _mjcf(option, 'timestep="0.001"><flag contact="disable"/></option>')
    yield Variant("laws that are switched off", "contact", contact, "harmless")


def what_hinders_drives(rng: np.random.Generator) -> Iterator[Variant]:
    """Put between a drive and its joint what the figures know nothing of; what changes nothing is harmless."""
    servo, joint = 'forcerange="-9000 9000"', '<joint name="hinge_a" axis="0 1 0" range="-1 2"'
    rotor, option = '<joint name="rotor_a" axis="0 1 0" armature="40.0"', 'timestep="0.001"'
    spring, compiler = '<plugin name="balance" tendon="balance"', '<compiler angle="radian"'
    added: dict[str, tuple[str, str, str]] = {
        "a gear of 2": (servo, 'gear="2"', "drives[0].servo: actuator 'servo_a' has gear"),
        "a gear that turns round": (servo, 'gear="-1"', "drives[0].servo: actuator 'servo_a' has gear"),
        "a gear of friction": ('name="link_friction_a"', 'gear="3"', "drives[0].link_friction"),
        "a gear of the gas": (spring, 'gear="0.5"', "counterbalance.actuator"),
        "a limit of the balance": ('<spatial name="balance"', 'actuatorfrcrange="-1 1"', "counterbalance.tendon"),
        "a posrange of 0.1 rad": (servo, 'posrange="-0.05 0.05"', "servo 'servo_a': posrange"),
        "a range of the rotor": (rotor, 'range="-0.01 0.01"', "joint 'rotor_a': range"),
        "a torque limit of the joint": (joint, 'actuatorfrcrange="-1 1"', "'hinge_a' has actuatorfrcrange"),
        "a torque limit of the rotor": (rotor, 'actuatorfrcrange="-1 1"', "'rotor_a' has actuatorfrcrange"),
        "a spring of the rotor": (rotor, 'stiffness="1000"', "'rotor_a' has a spring"),
        "friction of 9500 Nm": (joint, 'frictionloss="9500"', "drives[0]: Coulomb friction"),
        "damping of 1e5": (joint, 'damping="1e5"', "drives[0]: damping takes"),
        "masses of 50 kg at least": (compiler, 'boundmass="50"', "boundmass raises"),
        "inertias of 5 kg m^2 at least": (compiler, 'boundinertia="5"', "boundinertia raises"),
        "the moon": (option, 'gravity="0 0 -1.62"', "gravity is 1.62"),
        "no gravity": (option, 'gravity="0 0 0"', "gravity is 0 m/s^2"),
    }
    for name, (old, new, place) in added.items():
        yield Variant("what hinders drives", name, _mjcf(old, f"{old} {new}"), "error", (place,))
    harmless: dict[str, tuple[str, str]] = {
        "the joint's own range": (servo, 'posrange="-1 2"'),
        "the servo's own limit": (joint, 'actuatorfrcrange="-9000 9000"'),
        "masses of a microgram at least": (compiler, 'boundmass="1e-9"'),
        "a gravity of 9.8": (option, 'gravity="0 0 -9.8"'),
    }
    for name, (old, new) in harmless.items():
        yield Variant("what hinders drives", name, _mjcf(old, f"{old} {new}"), "harmless", (" 0 warnings",))


def what_only_mujoco_counts(rng: np.random.Generator) -> Iterator[Variant]:
    """Put inertia and friction where `bench run` counts them, and what holds a recording against the robot does not."""
    hinge, rotor = '<joint name="hinge_a"', '<joint name="rotor_a"'
    element, balance, tendons = '<fixed name="element_a"', '<spatial name="balance"', "</tendon>"
    both = '<joint joint="hinge_a" coef="1"/><joint joint="hinge_b" coef="-1"/></fixed></tendon>'
    added: dict[str, tuple[str, str, str]] = {
        "an armature of a link": (hinge, f'{hinge} armature="500"', "joint 'hinge_a' has armature=500"),
        "an armature of all": (
            "<worldbody>",
            '<default><joint armature="1000"/></default><worldbody>',
            "joint 'hinge_b' has armature=1000",
        ),
        "an armature of an element": (element, f'{element} armature="50"', "tendon 'element_a' has armature=50"),
        "an armature of the gas": (balance, f'{balance} armature="50"', "tendon 'balance' has armature=50"),
        "an armature of two joints": (tendons, f'<fixed name="c" armature="9">{both}', "tendon 'c' has armature=9"),
        "rubbing of a link": (hinge, f'{hinge} frictionloss="50"', "joint 'hinge_a' has frictionloss=50"),
        "rubbing of a rotor": (rotor, f'{rotor} frictionloss="50"', "joint 'rotor_a' has frictionloss=50"),
        "rubbing of an element": (element, f'{element} frictionloss="50"', "tendon 'element_a' has frictionloss=50"),
        "rubbing of two joints": (tendons, f'<fixed name="c" frictionloss="9">{both}', "tendon 'c' has frictionloss=9"),
        "a stop of an element": (element, f'{element} range="-1e-4 1e-4"', "'element_a' has a range"),
        "an element that is wound": (element, f'{element} springlength="0.1"', "'element_a' is at rest where"),
        "a joint's springref": (hinge, f'{hinge} springref="1"', "'element_a' is at rest where 'rotor_a' is -1 ahead"),
    }
    for name, (old, new, place) in added.items():
        yield Variant("what only MuJoCo counts", name, _mjcf(old, new), "error", ("robot/", place))


def other_machines(rng: np.random.Generator) -> Iterator[Variant]:
    """Make something else of the robot: what no serial arm has is refused, what changes nothing is harmless."""
    loose = '<body name="loose" pos="0 0 5"><freejoint/><geom size="0.5" mass="100"/></body>'
    ball = '<joint name="hinge_a" type="ball"/>'
    joint = '<joint name="hinge_a" axis="0 1 0" range="-1 2"/>'
    touching = 'contype="0" conaffinity="0"'
    wide = '<body name="post"><geom size="3" mass="1"/></body>'

    def touches(folder: Path) -> None:
        text = MJCF.replace(touching, "").replace("<worldbody>", f"<worldbody>{wide}")
        (folder / "robot" / ARM).write_text(text)

    def part(folder: Path) -> None:
        _before('<include file="part.xml"/>')(folder)
        (folder / "robot" / "part.xml").write_text('<mujoco><custom><numeric name="x" data="1"/></custom></mujoco>')

    changes: dict[str, tuple[Spoil, Answer, str]] = {
        "a free body beside it": (_in_world(loose), "error", "'loose'"),
        "a base that floats": (_mjcf('<body name="upper">', '<body name="upper"><freejoint/>'), "error", ""),
        "a ball joint in place of a hinge": (_mjcf(joint, ball), "error", "'hinge_a'"),
        "joints that are coupled": (
            _before('<equality><joint joint1="hinge_a" joint2="hinge_b"/></equality>'), "error", "equality"
        ),
        "a tool that is welded to the world": (
            _before('<equality><weld name="grip" body1="fore"/></equality>'), "error", "equality 'grip'"
        ),
        "shapes that touch": (touches, "error", "'post'"),
        "shapes of neighbours that overlap": (_mjcf(touching, "", 2), "error or harmless", ""),
        "an include": (part, "harmless", ""),
        "an include that is not there": (_before('<include file="nowhere.xml"/>'), "error", "nowhere.xml"),
        "twenty sites by replicate": (_in_world('<replicate count="20"><site/></replicate>'), "harmless", ""),
        "two arms by replicate": (
            _mjcf('<joint name="hinge_b"', '<replicate count="2"><geom size="0.1" mass="1"/></replicate>'
            '<joint name="hinge_b"'), "error or harmless", ""
        ),
        "a mesh that is not there": (
            _before('<asset><mesh name="m" file="nowhere.stl"/></asset>'), "error", "nowhere.stl"
        ),
        "a keyframe that is too short": (_keyframe("0 0"), "harmless", ""),  # MuJoCo takes the rest from the model
        "a keyframe that is too long": (_keyframe("0 0 0 0 0"), "error", "qpos"),
        "a body that a mouse moves": (
            _in_world('<body name="m" mocap="true"><geom size="0.1" contype="0" conaffinity="0"/></body>'),
            "harmless", "",
        ),
        "a name with a line break": (_mjcf('name="hinge_a"', 'name="hinge&#10;a"'), "error", "line break"),
    }  # fmt: skip
    for name, (spoil, answer, place) in changes.items():
        yield Variant("other machines", name, spoil, answer, (place,))


FAMILIES = (
    *(mjcf_that_crashes_its_reader, damaged_mjcf, attributes_of_plugins, parts_of_robots),
    *(numbers_of_no_robot, laws_switched_off, what_hinders_drives, what_only_mujoco_counts, other_machines),
)
