"""Names of the files of a run, and of those that are made from its log."""

from pathlib import Path

from saddlewalk.paths import source

LCM_LOG, CAN_LOG, TABLE, PICTURE = "walk.lcmlog", "walk.candump.log", "walk.csv", "walk.png"
STRIP, FILM = "body.png", "body.gif"  # of a body in MuJoCo
LEARNED = "learned.toml"
TABLE_FORMATS = ("csv", "parquet")


def table_names(form: str) -> tuple[str, ...]:
    """Of the tables of a log in a folder, one for each LCM type."""
    types = sorted(source("lcm_types").glob("*_t.lcm"))
    return tuple(f"{path.stem.removesuffix('_t')}.{form}" for path in types)


def exported(log: Path, form: str) -> Path:
    """The default output of an export: a file or, for tables, a folder."""
    return log.with_suffix(".mcap") if form == "mcap" else log.with_name(f"{log.stem}-{form}")


def reported(log: Path) -> Path:
    """The default path of a log's page."""
    return log.with_name(f"{log.name}.html")


def run_names() -> tuple[str, ...]:
    """All files of a run in its folder."""
    log = Path(LCM_LOG)
    made = [str(reported(log)), str(exported(log, "mcap"))]
    made += [
        str(exported(log, form) / name) for form in TABLE_FORMATS for name in table_names(form)
    ]
    return (LCM_LOG, CAN_LOG, TABLE, PICTURE, STRIP, FILM, LEARNED, *made)
