"""The CSV of a batch: a case a row, checked before anything is built."""

from __future__ import annotations

import csv
import difflib
import io
import re
from dataclasses import dataclass, field
from pathlib import Path

from clipgs_batch.options import FLAGS, OPTIONS, PATHS

NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}")


class TableError(Exception):
    """One line on why nothing of the CSV can be built."""


@dataclass(frozen=True)
class Case:
    """A row that can be built; `options` are those of clipgs build, by their long names."""

    name: str
    volume: str
    options: dict[str, str] = field(default_factory=dict)

    @property
    def is_neural(self) -> bool:
        return self.options.get("model") == "clipgs"

    @property
    def is_instant(self) -> bool:
        return self.options.get("quality") == "instant"


@dataclass(frozen=True)
class Refusal:
    """A row that cannot be built, and why, in one line."""

    name: str
    why: str


@dataclass(frozen=True)
class Table:
    cases: dict[str, Case]
    refused: dict[str, Refusal]


def read_table(path: Path, defaults: dict[str, object] | None = None) -> Table:
    """Checks the whole CSV. Paths in it are relative to its own folder; `defaults` are the options
    of rows that do not say otherwise. Raises TableError for what concerns all of it."""
    rows = _read_rows(path)
    usual = _checked_defaults(defaults or {})
    names = [row.get("name", "") for _, row in rows]
    table = Table({}, {})
    for line, row in rows:
        name = row.get("name", "")
        why = _problem_of_name(name, names) or _problem_of_row(row, path.parent)
        if why:
            table.refused[f"line-{line}"] = Refusal(f"line-{line}", f"{path.name}:{line}: {why}")
        else:
            table.cases[name] = _case(row, usual, path.parent)
    return table


def _read_rows(path: Path) -> list[tuple[int, dict[str, str]]]:
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise TableError(f"{path}: there is no such file; give a CSV of cases") from None
    except UnicodeDecodeError:
        raise TableError(f"{path}: is not UTF-8; save it as CSV UTF-8") from None
    except OSError as error:
        raise TableError(f"{path}: cannot be read ({error.strerror})") from None
    reader = csv.reader(io.StringIO(text, newline=""), strict=True)
    rows: list[tuple[int, dict[str, str]]] = []
    columns: list[str] | None = None
    try:
        for cells in reader:
            cells = [cell.strip() for cell in cells]
            if not any(cells):
                continue
            if columns is None:
                columns = _checked_columns(cells, path)
            else:
                rows.append((reader.line_num, _row(columns, cells)))
    except csv.Error as error:
        raise TableError(f"{path}:{reader.line_num}: is no CSV ({error})") from None
    if not rows:
        raise TableError(f"{path}: has no case; write a row for each, below a row of names")
    return rows


def _row(columns: list[str], cells: list[str]) -> dict[str, str]:
    row = {column: cell for column, cell in zip(columns, cells) if cell}
    if any(cells[len(columns) :]):
        row["too-many"] = cells[len(columns)]
    return row


def _checked_columns(cells: list[str], path: Path) -> list[str]:
    if len(cells) == 1 and ";" in cells[0]:
        raise TableError(f"{path}: its columns are separated by ;, save it with commas")
    columns = [cell.lower().replace("_", "-").lstrip("-") for cell in cells]
    known = ["name", "volume", *OPTIONS]
    for cell, column in zip(cells, columns):
        if column not in known:
            near = difflib.get_close_matches(column, known, 1)
            hint = f'did you mean "{near[0]}"?' if near else "columns are in docs/batch.md"
            raise TableError(f'{path}: there is no column "{cell}"; {hint}')
        if columns.count(column) > 1:
            raise TableError(f'{path}: has two columns "{column}"; leave one of them out')
    for needed in ("name", "volume"):
        if needed not in columns:
            raise TableError(f'{path}: has no column "{needed}"; every case needs one')
    return columns


def _problem_of_name(name: str, names: list[str]) -> str:
    if not name:
        return "has no name; it becomes the name of the case's file"
    if not NAME.fullmatch(name):
        return (
            f'"{name}" is no name; it becomes a file\'s: up to 64 of A-Z a-z 0-9 . _ -, a letter '
            "or digit first"
        )
    if name.lower().startswith("line-"):
        return f'"{name}" is what rows that cannot be built are called; choose another name'
    if sum(name.lower() == other.lower() for other in names) > 1:
        return f'"{name}" is the name of another row, too; none of them is built'
    return ""


def _problem_of_row(row: dict[str, str], folder: Path) -> str:
    if "too-many" in row:
        return f'"{row["too-many"]}" stands in no column; put what has commas in it into quotes'
    if "volume" not in row:
        return "has no volume"
    if not (folder / row["volume"]).exists():
        return f"{row['volume']}: there is no such volume"
    for option in sorted(PATHS & row.keys()):
        if _is_path(option, row[option]) and not (folder / row[option]).is_file():
            return f"{option} {row[option]}: there is no such file"
    return _problem_of_options(row)


def _problem_of_options(row: dict[str, str]) -> str:
    for option in FLAGS & row.keys():
        if row[option].lower() not in ("yes", "no"):
            return f'{option} is yes or no, not "{row[option]}"'
    if "," in row.get("preset", ""):
        return f'preset "{row["preset"]}": write a row for each look'
    return ""


def _is_path(option: str, value: str) -> bool:
    """Presets and lights are files or names of those that come with the program."""
    return option in ("labels", "label-table") or "/" in value or "." in value


def _checked_defaults(defaults: dict[str, object]) -> dict[str, str]:
    usual = {}
    for option, value in defaults.items():
        if option not in OPTIONS:
            raise TableError(f'config: "{option}" of options is none of clipgs build')
        is_flag = isinstance(value, bool)
        usual[option] = (
            ("yes" if value else "no") if is_flag else "" if value is None else str(value)
        )
    why = _problem_of_options(usual)
    if why:
        raise TableError(f"config: options: {why}")
    return usual


def _case(row: dict[str, str], usual: dict[str, str], folder: Path) -> Case:
    given = {option: row[option] for option in OPTIONS if option in row}
    for option in PATHS & given.keys():
        if _is_path(option, given[option]):
            given[option] = str((folder / given[option]).resolve())
    options = {option: value for option, value in {**usual, **given}.items() if value}
    for option in FLAGS & options.keys():
        options[option] = options[option].lower()
    return Case(row["name"], str((folder / row["volume"]).resolve()), options)
