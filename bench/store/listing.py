"""What the store holds, in words."""

from bench.store.store import Entry, Store

STEPS = ((60.0, "second"), (60.0, "minute"), (24.0, "hour"), (float("inf"), "day"))
UNITS = ("bytes", "kB", "MB", "GB")


def words_of(store: Store, now_s: float) -> list[str]:
    """Return the folder, its size and limit, and a line for all entries of one label.

    Args:
        store: What to list.
        now_s: Seconds since 1970.
    """
    entries = store.entries()
    total = sum(entry.size for entry in entries)
    lines = [
        f"folder     {store.folder}",
        f"size       {size_words(total)} of {size_words(store.limit_bytes)} at most",
    ]
    labels: dict[str, list[Entry]] = {}
    for entry in entries:
        labels.setdefault(entry.label or "damaged", []).append(entry)
    for label, alike in labels.items():
        count = f"{len(alike)} {'entry' if len(alike) == 1 else 'entries'}"
        size = size_words(sum(entry.size for entry in alike))
        used = age_words(now_s - max(entry.used_s for entry in alike))
        made = age_words(now_s - min(entry.made_s for entry in alike)) if label != "damaged" else "unknown"
        lines.append(f"{count:>12}  {size:>8}  made {made}, used {used}: {label}")
    return lines


def size_words(size: float) -> str:
    """Return a size, "31.3 MB"; three digits."""
    for unit in UNITS:
        if size < 999.5 or unit == UNITS[-1]:
            return f"{size:.3g} {unit}"
        size /= 1000
    raise AssertionError(size)


def age_words(age_s: float) -> str:
    """Return how long ago something was, "3 hours ago"."""
    age = max(age_s, 0.0)
    for step, unit in STEPS:
        if age < step:
            return f"{age:.0f} {unit}{'' if round(age) == 1 else 's'} ago"
        age /= step
    raise AssertionError(age)
