"""A study for people: study.json with every campaign, and study.html on one page."""
