"""What `bench compare` prints and writes: words, compare.json, and a page."""
