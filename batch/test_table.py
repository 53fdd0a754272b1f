#!/usr/bin/env python3
"""Tests of what needs no volume: tables, the commands of steps, what schedulers are asked for."""

from __future__ import annotations

import json
import tempfile
import unittest
from pathlib import Path

from clipgs_batch.needs import request_of
from clipgs_batch.options import OPTIONS, STEPS, command_of
from clipgs_batch.table import Case, Table, TableError, read_table


class TableTest(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        (self.folder / "ct.nrrd").write_text("")
        (self.folder / "labels.nrrd").write_text("")

    def read(self, text: str, defaults: dict[str, object] | None = None) -> Table:
        path = self.folder / "cases.csv"
        path.write_bytes(text.encode("utf-8") if isinstance(text, str) else text)
        return read_table(path, defaults)

    def problem_of(self, text: str, defaults: dict[str, object] | None = None) -> str:
        with self.assertRaises(TableError) as caught:
            self.read(text, defaults)
        self.assertNotIn("\n", str(caught.exception))
        return str(caught.exception)

    def refusal_of(self, row: str, columns: str = "name,volume") -> str:
        table = self.read(f"{columns}\n{row}\ngood,ct.nrrd\n")
        self.assertEqual(list(table.cases), ["good"])
        (refusal,) = table.refused.values()
        self.assertNotIn("\n", refusal.why)
        return refusal.why

    def test_rows_become_cases(self) -> None:
        table = self.read(
            "\ufeffName,volume,train_frames,title,bias,labels\r\n"
            'a.1,ct.nrrd,5,"Head, bone",Yes,labels.nrrd\r\n\r\nb,ct.nrrd\r\n',
            {"quality": "draft", "train-frames": 9, "denoise": True, "bias": False},
        )
        self.assertFalse(table.refused)
        self.assertEqual(
            table.cases["a.1"],
            Case(
                "a.1",
                str(self.folder / "ct.nrrd"),
                {
                    "quality": "draft",
                    "train-frames": "5",
                    "denoise": "yes",
                    "bias": "yes",
                    "title": "Head, bone",
                    "labels": str(self.folder / "labels.nrrd"),
                },
            ),
        )
        self.assertEqual(table.cases["b"].options["train-frames"], "9")

    def test_what_concerns_the_whole_table(self) -> None:
        self.assertIn("no such file", self._problem_of_absent())
        self.assertIn("has no case", self.problem_of(""))
        self.assertIn("has no case", self.problem_of("name,volume\n\n"))
        self.assertIn('no column "volume"', self.problem_of("name\na\n"))
        self.assertIn('did you mean "quality"', self.problem_of("name,volume,qualty\na,b,c\n"))
        self.assertIn('no column "colour"', self.problem_of("name,volume,colour\na,b,c\n"))
        self.assertIn("two columns", self.problem_of("name,volume,Name\na,b,c\n"))
        self.assertIn("commas", self.problem_of("name;volume\na;b\n"))
        self.assertIn("is no CSV", self.problem_of('name,volume\n"a,b\n'))
        self.assertIn("config", self.problem_of("name,volume\na,ct.nrrd\n", {"colour": "red"}))
        self.assertIn("yes or no", self.problem_of("name,volume\na,ct.nrrd\n", {"bias": 3}))
        (self.folder / "cases.csv").write_bytes(b"name,volume\nM\xfcller,ct.nrrd\n")
        with self.assertRaisesRegex(TableError, "UTF-8"):
            read_table(self.folder / "cases.csv")

    def _problem_of_absent(self) -> str:
        with self.assertRaises(TableError) as caught:
            read_table(self.folder / "absent.csv")
        return str(caught.exception)

    def test_one_bad_row_leaves_the_others(self) -> None:
        self.assertIn("has no name", self.refusal_of(",ct.nrrd"))
        for name in ("../a", "a/b", ".a", "-a", "a b", "M\u00fcller", "a" * 65, "line-3"):
            self.assertRegex(self.refusal_of(f"{name},ct.nrrd"), "name")
        self.assertIn("has no volume", self.refusal_of("a,"))
        self.assertIn("no such volume", self.refusal_of("a,absent.nrrd"))
        self.assertIn("stands in no column", self.refusal_of("a,ct.nrrd,Head"))
        self.assertIn("no such file", self.refusal_of("a,ct.nrrd,l.nrrd", "name,volume,labels"))
        self.assertIn("no such file", self.refusal_of("a,ct.nrrd,my.json", "name,volume,preset"))
        self.assertIn("yes or no", self.refusal_of("a,ct.nrrd,1", "name,volume,bias"))
        self.assertIn("each look", self.refusal_of('a,ct.nrrd,"a,b"', "name,volume,preset"))

    def test_doubled_names_are_all_refused(self) -> None:
        table = self.read("name,volume\na,ct.nrrd\nb,ct.nrrd\nA,ct.nrrd\n")
        self.assertEqual(list(table.cases), ["b"])
        self.assertEqual(list(table.refused), ["line-2", "line-4"])


class CommandsTest(unittest.TestCase):
    def test_every_option_reaches_the_build_and_its_step(self) -> None:
        for option, steps in OPTIONS.items():
            case = Case("a", "/ct.nrrd", {option: "yes"})
            words = " ".join(command_of("build", case, False))
            self.assertIn(f"--{option}", words)
            for step in steps:
                self.assertIn(f"--{option}", " ".join(command_of(step, case, True)), step)

    def test_the_papers_way_shares_its_steps(self) -> None:
        case = Case("a", "/ct.nrrd", {"model": "clipgs", "steps": "7"})
        self.assertIn("--steps=3", command_of("train", case, True))
        self.assertIn("--steps=4", command_of("refine", case, True))
        self.assertIn("--one-sided", command_of("dataset", case, True))
        self.assertNotIn("--model=clipgs", command_of("dataset", case, True))

    def test_instant_cases_are_told_nothing_of_training(self) -> None:
        case = Case("a", "/ct.nrrd", {"quality": "instant", "steps": "7", "uncut-frames": "2"})
        words = " ".join(command_of("build", case, True))
        self.assertNotIn("steps", words)
        self.assertNotIn("uncut", words)

    def test_another_title_needs_nothing_else(self) -> None:
        commands = [
            command_of("needs", Case("a", "/ct.nrrd", {"steps": "7", **more}), True)
            for more in ({}, {"title": "A", "max-mb": "3"})
        ]
        self.assertEqual(commands[0], commands[1])

    def test_no_step_is_without_a_command(self) -> None:
        for step in STEPS:
            self.assertTrue(command_of(step, Case("a", "/ct.nrrd"), True))


class NeedsTest(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.file = str(Path(folder.name) / "needs.json")
        steps = {
            "dataset": {"memory_mb": 1000, "seconds": 600},
            "train": {"memory_mb": 400, "seconds": 1200},
            "pack": {"memory_mb": 500, "seconds": 60},
            "eval": {"memory_mb": 5000, "seconds": 5},
        }
        Path(self.file).write_text(json.dumps({"steps": steps}))

    def test_a_step_asks_for_its_own(self) -> None:
        request = request_of("train", self.file, 2, 1, 1.5, 3)
        self.assertEqual((request.mem_mb, request.minutes), (600, 60))

    def test_a_build_in_one_asks_for_the_most_and_the_sum(self) -> None:
        request = request_of("build", self.file, 4, 1, 1, 2)
        self.assertEqual((request.mem_mb, request.minutes), (1000, 31))

    def test_a_second_attempt_asks_for_twice_as_much(self) -> None:
        request = request_of("bake", self.file, 2, 2, 1, 3)
        self.assertEqual((request.mem_mb, request.minutes), (800, 120))

    def test_unknown_needs_are_told(self) -> None:
        with self.assertRaises(FileNotFoundError):
            request_of("train", self.file + ".absent", 2, 1, 1, 1)


if __name__ == "__main__":
    unittest.main()
