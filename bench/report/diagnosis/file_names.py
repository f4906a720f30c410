"""The files in the folder of a diagnosis."""

VERDICT = "verdict.json"
REPORT = "report.html"
RECORDING = "diagnosis.rrd"
EXTENDED = "extended.xml"
DIFFERENCE = "extended.diff"
WORDS = {
    VERDICT: "all numbers of this page",
    EXTENDED: "the extended model",
    DIFFERENCE: "its difference from the nominal one",
    RECORDING: "the runs replayed, in the Rerun viewer: bench view and this folder",
}
