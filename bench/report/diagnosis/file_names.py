"""The files in the folder of a diagnosis."""

VERDICT = "verdict.json"
REPORT = "report.html"
RECORDING = "diagnosis.rrd"
ROBOT = "robot"
NOMINAL_MJCF = "nominal.xml"
DIFFERENCE = "robot.diff"
FIGURES = "figures.csv"
TEXT = "verdict.txt"
WORDS = {
    VERDICT: "all numbers of this page",
    TEXT: "the verdict in words",
    ROBOT: "a robot folder with everything fitted in it",
    NOMINAL_MJCF: "the nominal MJCF as MuJoCo writes it",
    DIFFERENCE: "what makes the MJCF of that folder of the nominal one: patch nominal.xml robot.diff",
    FIGURES: "everything that was fitted: stated, found, interval",
    RECORDING: "the runs replayed, in the Rerun viewer: bench view and this folder",
}
