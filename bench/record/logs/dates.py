"""Dates with times of day in a log, as seconds since 1970."""

import re
from datetime import UTC, datetime, timedelta
from decimal import Decimal

LOOKED_AT = (
    4096  # bytes from the beginning in which a date must stand, else there are none (assumed: headers are shorter)
)
_STAMP = re.compile(
    rb"(\d{4})-(\d{2})-(\d{2})[T ](\d{2}):(\d{2}):(\d{2})(\.\d+)?(?:(Z)|([+-])(\d{2}):(\d{2}))?(?![\d:])"  # ISO 8601
)
EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
DATED = (
    datetime(2001, 1, 1, tzinfo=UTC),  # a clock that lost its battery begins anew in 1900, 1904, 1970, 1980 or 2000
    datetime(2101, 1, 1, tzinfo=UTC),  # years of a campaign end there (bench/record/manifest.py)
)


def in_seconds(data: bytes) -> bytes:
    """Return a text with seconds since 1970 in place of dates like 2024-05-13T09:00:00.002+02:00; UTC if no zone."""
    return _STAMP.sub(_seconds, data) if _STAMP.search(data[:LOOKED_AT]) else data


def _seconds(found: re.Match[bytes]) -> bytes:
    fraction, _, sign, hours, minutes = found.groups()[6:]
    try:
        moment = datetime(*(int(number) for number in found.groups()[:6]), tzinfo=UTC)  # type: ignore[misc, arg-type]
    except ValueError:  # no such day or hour: it stays, and is told to be no number
        return found[0]
    zone = (-1 if sign == b"-" else 1) * timedelta(hours=int(hours or 0), minutes=int(minutes or 0))
    whole = int((moment - EPOCH - zone).total_seconds())  # in UTC it may be a moment outside of years 1 to 9999
    if whole < 0 and fraction:  # the fraction counts upwards, the digits of a negative number downwards
        return f"{whole + Decimal(fraction.decode()):f}".encode()
    return b"%d" % whole + (fraction or b"")


def is_dated(seconds: float) -> bool:
    """Whether a reading of a clock [s] is a moment, counted from 1970; no machine is on for thirty years."""
    return (DATED[0] - EPOCH).total_seconds() <= seconds < (DATED[1] - EPOCH).total_seconds()
