"""A two-joint robot folder with every part that the bench knows, small enough to check by hand.

Both hinges turn about y; link 1 stands upright, link 2 points forward; a counterbalance pulls on joint 1.
"""

from pathlib import Path

import yaml

K = (2.0e5, 1.0e5)  # [Nm/rad]
ROTOR = (40.0, 20.0)  # [kg m^2]
FRICTION = (60.0, 30.0)  # [Nm], on each side
C, L_C = 900.0, 0.60  # [Nm], [m]
LINK = (0.8, 0.7)  # [m]
MASS = (40.0, 25.0)  # [kg], halfway along the link

_ELEMENTS = "".join(
    f'<fixed name="element_{i}" stiffness="{k}" damping="{0.002 * k}">'
    f'<joint joint="rotor_{i}" coef="1"/><joint joint="hinge_{i}" coef="-1"/></fixed>'
    for i, k in zip("ab", K, strict=True)
)
_SERVOS = "".join(
    f'<pid name="servo_{i}" joint="rotor_{i}" kp="{j * 3600}" kv="{j * 120}" ki="{j * 36000}" forcerange="-9000 9000"/>'
    for i, j in zip("ab", ROTOR, strict=True)
)
_FRICTION = "".join(
    f'<plugin name="{side}_friction_{i}" joint="{joint}_{i}" plugin="bench.friction">'
    f'<config key="coulomb" value="{level}"/><config key="presliding_stiffness" value="4e5"/></plugin>'
    for i, level in zip("ab", FRICTION, strict=True)
    for side, joint in (("motor", "rotor"), ("link", "hinge"))
)
_ROTORS = "".join(
    f'<body name="rotor_{i}"><inertial pos="0 0 0" mass="0.001" diaginertia="1e-9 1e-9 1e-9"/>'
    f'<joint name="rotor_{i}" axis="0 1 0" armature="{j}"/></body>'
    for i, j in zip("ab", ROTOR, strict=True)
)

MJCF = f"""
<mujoco model="small">
  <extension><plugin plugin="bench.friction"/><plugin plugin="bench.gas_spring"/></extension>
  <compiler angle="radian"/>
  <option integrator="implicitfast" timestep="0.001"/>
  <worldbody>
    <site name="anchor_a" pos="-0.02 0 -0.5"/>
    {_ROTORS}
    <body name="upper">
      <inertial pos="0 0 {LINK[0] / 2}" mass="{MASS[0]}" diaginertia="2.2 2.1 0.2"/>
      <joint name="hinge_a" axis="0 1 0" range="-1 2"/>
      <geom type="capsule" fromto="0 0 0 0 0 {LINK[0]}" size="0.06" contype="0" conaffinity="0"/>
      <site name="anchor_b" pos="0 0 -0.12"/>
      <body name="fore" pos="0 0 {LINK[0]}">
        <inertial pos="{LINK[1] / 2} 0 0" mass="{MASS[1]}" diaginertia="0.12 1.1 1.0"/>
        <joint name="hinge_b" axis="0 1 0" range="-2 2"/>
        <geom type="capsule" fromto="0 0 0 {LINK[1]} 0 0" size="0.05" contype="0" conaffinity="0"/>
        <site name="hook" pos="{LINK[1]} 0 0"/>
        <site name="nest_1" pos="{LINK[1]} 0.1 0.2"/>
        <site name="nest_2" pos="{LINK[1]} -0.2 0"/>
        <site name="nest_3" pos="{LINK[1] - 0.2} 0.1 0"/>
        <body name="load" pos="{LINK[1]} 0 0"><inertial pos="0 0 0" mass="0" diaginertia="0 0 0"/></body>
      </body>
    </body>
  </worldbody>
  <tendon>
    {_ELEMENTS}
    <spatial name="balance"><site site="anchor_a"/><site site="anchor_b"/></spatial>
  </tendon>
  <actuator>
    {_SERVOS}
    {_FRICTION}
    <plugin name="balance" tendon="balance" plugin="bench.gas_spring">
      <config key="constant" value="{C}"/><config key="critical_length" value="{L_C + 0.05}"/>
    </plugin>
  </actuator>
</mujoco>
"""

FIGURES = {
    "title": "two-joint test robot",
    "mjcf": "small.xml",
    "drives": [
        {
            "joint": f"hinge_{i}",
            "rotor": f"rotor_{i}",
            "element": f"element_{i}",
            "servo": f"servo_{i}",
            "motor_friction": f"motor_friction_{i}",
            "link_friction": f"link_friction_{i}",
            "torque_constant_nm_per_a": 100.0,
            "speed_limit_rad_per_s": 2.0,
        }
        for i in "ab"
    ],
    "load_body": "load",
    "load_point": "hook",
    "reflectors": ["nest_1", "nest_2", "nest_3"],
    "counterbalance": {"joint": "hinge_a", "tendon": "balance", "actuator": "balance"},
    "rating": {"force_n": 300.0, "moment_nm": 50.0},
    "instruments": {
        "tracker": {"position_m": [3.0, 0.5, 0.5]},
        "force": {},
        "current": {"sigma_a": 0.02},
        "encoder": {},
        "pressure": {"piston_area_m2": 0.001},
    },
}


def write_small_robot(folder: Path) -> Path:
    """Write the robot's files into `folder` and return it."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "small.xml").write_text(MJCF)
    (folder / "figures.yaml").write_text(yaml.safe_dump(FIGURES))
    return folder
