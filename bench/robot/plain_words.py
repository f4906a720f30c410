"""MuJoCo's errors in one line, with what to do about those that a robot folder usually has."""

REMEDIES = {
    "mass and inertia of moving bodies": "give the body positive mass and inertia, or geoms with a mass",
    "mass and inertia cannot be negative": "write its mass and inertia as positive numbers",
    "inertia must satisfy": "check its inertia: no principal moment exceeds the sum of the other two",
    "unknown transmission target": "name a joint or tendon that the file has, or add it",
    "not found in tendon": "name a joint or site that the file has, or add it",
    "unknown element": "name a part that the file has, or add it",
    "rror opening file": (
        "put the file where the MJCF says, or correct meshdir; geoms of type mesh, with their <mesh>, may be deleted "
        "where bodies have their <inertial>; package:// is followed in a URDF alone, by `bench new-robot`"
    ),
    "unknown plugin": "declare it under <extension>; bench/actuators/README.md has the names",
}


def plain_words(error: ValueError) -> str:
    """Return what MuJoCo said, in one line, and a remedy where one is known."""
    words = " ".join(str(error).removeprefix("Error: ").split())
    remedy = next((remedy for sign, remedy in REMEDIES.items() if sign in words), "")
    return f"{words}; {remedy}." if remedy else words
