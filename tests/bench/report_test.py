"""What deploy/bench makes of values: nothing is measured here."""

import importlib.machinery
import importlib.util
import json
import struct
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as xml
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE / "measure")]

import lab  # noqa: E402
from report import machine, page, rounds, svg, text  # noqa: E402
from report.figures import BY_NAME, Figure, Goal  # noqa: E402
from report.programs import PROGRAMS, Failed, Program, end, measure  # noqa: E402
from report.summary import Spread, Summary, judge, spread  # noqa: E402
from report.values import Value, parse_all  # noqa: E402

GOOD = ('{"figure": "tick", "case": "gyrocar", "subject": "MuJoCo", "quantity": "p50", '
        '"unit": "us", "value": 22.5}')


def python(code, **more):
    """A measuring program that is a line of Python."""
    return Program("told", ("tick",), sys.executable, ("-c", code), **more)


def ratio_rounds(*pairs, quantity="p50", unit="us", figure="round_trip", peer="liblcm", case=""):
    """Rounds in which ours and a peer's have these values."""
    return [(number, [Value(figure, case, "gyrotwin", quantity, unit, ours),
                      Value(figure, case, peer, quantity, unit, theirs)])
            for number, (ours, theirs) in enumerate(pairs, 1)]


def script(path):
    """A program of this folder as a module."""
    loader = importlib.machinery.SourceFileLoader("script", str(HERE / path))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("script", loader))
    loader.exec_module(module)
    return module


class Running(unittest.TestCase):
    def test_programs_are_found_by_their_names(self):
        words = ["/opt/lab/benchtest-daemon", "-c", "echo ready; read word"]
        with subprocess.Popen(words, executable="/bin/sh", stdin=subprocess.PIPE,
                              stdout=subprocess.PIPE) as process:
            process.stdout.readline()
            self.assertEqual(machine.running("benchtest-"), [f"benchtest-daemon ({process.pid})"])
            process.kill()
        self.assertEqual(machine.running("benchtest-"), [])


class Lines(unittest.TestCase):
    def test_a_value(self):
        values, mistakes = parse_all(GOOD + "\n")
        self.assertEqual(values, [Value("tick", "gyrocar", "MuJoCo", "p50", "us", 22.5)])
        self.assertEqual(mistakes, [])

    def test_malformed_lines_are_told_and_the_others_stay(self):
        wrong = {
            "hello": "not JSON",
            "[1]": "not a JSON object",
            GOOD.replace('"unit": "us", ', ""): "no `unit`",
            GOOD.replace("}", ', "more": 1}'): "`more` is not a field",
            GOOD.replace("22.5", '"22.5"'): "`value` is not a finite number",
            GOOD.replace("22.5", "NaN"): "`value` is not a finite number",
            GOOD.replace("22.5", "true"): "`value` is not a finite number",
            GOOD.replace('"gyrocar"', "7"): "`case` is not a text",
            GOOD.replace('"tick"', '"Tick 1"'): "`figure` is not made of",
            GOOD.replace('"us"', '"min"'): "`min` is not a unit",
        }
        for line, what in wrong.items():
            values, mistakes = parse_all(f"{GOOD}\n{line}\n{GOOD}")
            self.assertEqual(len(values), 2, line)
            self.assertEqual(len(mistakes), 1, line)
            self.assertIn(f"line 2: {what}", mistakes[0])


class Statistics(unittest.TestCase):
    def test_median_and_quartiles(self):
        self.assertEqual(spread([5, 1, 4, 2, 3]), Spread(3, 2, 4, 5))
        self.assertEqual(spread([7]), Spread(7, 7, 7, 1))

    def test_a_ratio_is_taken_inside_a_round(self):
        # The machine grew slower from round to round; ours was half of theirs in each.
        summary = Summary(ratio_rounds((10, 20), (15, 30), (40, 80)))
        self.assertEqual(summary.ratio("round_trip", "", "p50", "liblcm"), Spread(0.5, 0.5, 0.5, 3))
        # Medians of each would say 15 / 25.
        summary = Summary(ratio_rounds((10, 25), (15, 20), (40, 80)))
        self.assertEqual(summary.ratio("round_trip", "", "p50", "liblcm").median, 0.5)

    def test_a_round_without_the_peer_has_no_ratio(self):
        told = ratio_rounds((10, 20), (15, 30), (40, 0))
        del told[1][1][1]
        self.assertEqual(Summary(told).ratio("round_trip", "", "p50", "liblcm").rounds, 1)
        self.assertIsNone(Summary(told).ratio("round_trip", "", "p50", "ZeroMQ"))

    def test_what_one_round_tells_twice_is_one_value(self):
        told = ratio_rounds((10, 20)) + ratio_rounds((30, 20))
        self.assertEqual(Summary(told).value("round_trip", "", "p50").rounds, 1)
        self.assertEqual(Summary(told).value("round_trip", "", "p50").median, 20)

    def test_goals(self):
        figure = Figure("round_trip", "", "", goals=(Goal("p50", 0.45, "liblcm"),))
        for pairs, answer in {((4, 10), (4, 10), (9, 10)): "unsure", ((4, 10),) * 3: "yes",
                              ((6, 10), (5, 10), (9, 10)): "no"}.items():
            judged, = judge(Summary(ratio_rounds(*pairs)), figure)
            self.assertEqual(judged.reached, answer, pairs)

    def test_a_goal_holds_in_its_case_alone_and_may_be_a_least(self):
        figure = Figure("rigs", "", "", goals=(Goal("held", 15, at_least=True, case=""),))
        told = [(1, [Value("rigs", "", "gyrotwin", "held", "1", 14),
                     Value("rigs", "4", "gyrotwin", "held", "1", 20)])]
        judged, = judge(Summary(told), figure)
        self.assertEqual((judged.case, judged.reached), ("", "no"))

    def test_numbers_for_people(self):
        self.assertEqual([text.digits(v) for v in (0, 0.04131, 7.2, 153.4, 12400, 10, 3e-6)],
                         ["0", "0.0413", "7.2", "153", "12,400", "10", "3e-06"])
        self.assertEqual(text.measured(0.0213, "us"), "21.3 ns")
        self.assertEqual(text.measured(1500, "us"), "1.5 ms")
        self.assertEqual(text.measured(0.4, "1", percent=True), "40 %")
        self.assertEqual(text.with_quartiles(Spread(12, 11, 14, 5), "us"), "12 µs (11 to 14)")
        self.assertEqual(text.with_quartiles(Spread(900, 800, 1200, 5), "us"),
                         "900 µs (800 µs to 1.2 ms)")


class Programs(unittest.TestCase):
    def test_values_and_malformed_lines_of_a_program(self):
        values, mistakes, _ = measure(python(f"print('''{GOOD}'''); print('oops')"))
        self.assertEqual((len(values), len(mistakes)), (1, 1))
        self.assertIn("line 2: not JSON: oops", mistakes[0])

    def test_why_a_program_gives_nothing(self):
        for program, why in {
            python("import sys; sys.exit('MuJoCo is missing: apt-get install it')"): "MuJoCo is missing",
            python("import sys; sys.exit(3)"): "ended with 3",
            python("pass"): "no value",
            python("print('oops')"): "not JSON",
            python("import time; time.sleep(600)", limit_s=0.2): "not done within",
            Program("gone", ("tick",), "/nowhere/gone"): "is not there",
        }.items():
            with self.assertRaisesRegex(Failed, why):
                measure(program)

    def test_what_hangs_is_ended_with_its_children(self):
        child = "import time; print('up', flush=True); time.sleep(600)"
        hang = ("import subprocess, sys, time; "
                f"subprocess.Popen([sys.executable, '-c', {child!r}]); time.sleep(600)")
        with subprocess.Popen([sys.executable, "-c", hang], stdout=subprocess.PIPE, text=True,
                              stderr=subprocess.DEVNULL, start_new_session=True) as running:
            self.assertEqual(running.stdout.readline(), "up\n")
            end(running)
            self.assertEqual(running.stdout.read(), "")  # ends when nobody holds the pipe any more

    def test_who_fails_is_left_out_and_the_others_go_on(self):
        good = python(f"print('''{GOOD}''')")
        bad = Program("bad", ("tick",), sys.executable, ("-c", "import sys; sys.exit('no such peer')"))
        seldom = Program("seldom", ("tick",), good.file, good.words, rounds=1)
        rounds.say, said = lambda line="": None, rounds.say
        try:
            result = rounds.run([bad, good, seldom], {}, 3, quick=False)
        finally:
            rounds.say = said
        self.assertEqual(result["left_out"], {"bad": "round 1: no such peer"})
        self.assertEqual([(part["round"], part["program"]) for part in result["rounds"]],
                         [(1, "told"), (1, "seldom"), (2, "told"), (3, "told")])

    def test_every_figure_has_a_program_and_a_place(self):
        measured = {figure for program in PROGRAMS for figure in program.figures}
        self.assertEqual(measured, set(BY_NAME))

    def test_a_machine_is_told(self):
        facts = machine.facts()
        self.assertTrue(facts["cpu"] and facts["cores"] and facts["kernel"])
        self.assertEqual(machine.slug("Intel(R) Core(TM) i7-8650U CPU @ 1.90GHz"),
                         "intel-core-i7-8650u")


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.text = (HERE / "report_sample.json").read_text()
        cls.result = json.loads(cls.text)
        cls.html = page.page(cls.result, "sample.json")

    def test_it_shows_every_figure_and_needs_no_network(self):
        for name in {value[0] for part in self.result["rounds"] for value in part["values"]}:
            self.assertIn(f'id="{name}"', self.html)
        self.assertNotIn("http", self.html)
        self.assertNotIn("<script", self.html)
        self.assertIn("prefers-color-scheme: dark", self.html)

    def test_plots_are_drawn_for_wide_and_narrow_pages(self):
        drawings = self._drawings()
        kinds = [drawing.get("class") for drawing in drawings]
        self.assertEqual(kinds.count("wide"), kinds.count("narrow"))
        self.assertGreater(kinds.count("wide"), 5)
        self.assertGreater(kinds.count("small"), 5)

    def test_texts_of_a_plot_stay_inside_and_apart(self):
        for drawing in self._drawings():
            boxes = [self._box(text) for text in drawing.iter("text")]
            width = float(drawing.get("viewBox").split()[2])
            for left, right, y, word in boxes:
                self.assertGreaterEqual(left, -1, word)
                self.assertLessEqual(right, width + 1, word)
            for k, (left, right, y, word) in enumerate(boxes):
                for other_left, other_right, other_y, other in boxes[:k]:
                    apart = right <= other_left or other_right <= left or abs(y - other_y) >= 11
                    self.assertTrue(apart, f"{drawing.get('aria-label')}: {word} | {other}")

    def test_what_is_left_out_and_malformed_is_told(self):
        result = self.result | {"left_out": {"loop": "no <ZeroMQ>"}}
        result["rounds"] = [part | {"malformed": ["line 3: not JSON: oops"]}
                            for part in result["rounds"][:1]]
        html = page.page(result, "x.json")
        self.assertIn("no &lt;ZeroMQ&gt;", html)
        self.assertIn("line 3: not JSON: oops", html)

    def test_a_figure_that_nobody_described_is_shown_in_numbers(self):
        result = self.result | {"rounds": [{
            "round": 1, "program": "new", "malformed": [],
            "values": [["brand_new", "", "<peer>", "p50", "us", 3.0]]}]}
        html = page.page(result, "x.json")
        self.assertIn("Brand new", html)
        self.assertIn("&lt;peer&gt;", html)

    def test_a_result_survives_its_file(self):
        self.assertEqual(json.loads(rounds.as_text(self.result)), self.result)
        self.assertEqual(rounds.as_text(self.result), self.text)

    def test_the_text_names_ratios_and_goals(self):
        lines = "\n".join(rounds.report(Summary(rounds.values_of(self.result))))
        self.assertRegex(lines, r"gyrotwin / liblcm = .* µs / .* µs = 0\.\d+ \(")
        self.assertRegex(lines, r"(reached|MISSED|unsure) +one_core, p50: .*goal ≤ 0.45 of liblcm")

    def _drawings(self):
        found = []
        for piece in self.html.split("<svg")[1:]:
            found.append(xml.fromstring("<svg" + piece.split("</svg>")[0] + "</svg>"))
        return found

    @staticmethod
    def _box(element):
        width = svg.text_width(element.text)
        if element.get("class") in ("tick", "caption"):
            width *= 11 / 12  # their font
        x = float(element.get("x"))
        left = {"start": x, "middle": x - width / 2, "end": x - width}[element.get("text-anchor")]
        return left, left + width, float(element.get("y")), element.text


class Climbs(unittest.TestCase):
    def climb(self, held, missing=()):
        """The highest of five levels, and which were tried."""
        tried = []

        def holds(level):
            tried.append(level)
            if level in missing:
                raise lab.Missing("it does not start")
            return level in held

        lab.say, said = lambda text: None, lab.say
        try:
            return lab.climb("rigs", (1, 2, 4, 8, 15), holds), tried
        finally:
            lab.say = said

    def test_one_level_that_fails_does_not_end_it_and_two_in_a_row_do(self):
        self.assertEqual(self.climb({1, 4, 15}), (15, [1, 2, 4, 8, 15]))
        self.assertEqual(self.climb({1, 8}), (1, [1, 2, 4]))
        self.assertEqual(self.climb({}), (0, [1, 2]))

    def test_what_does_not_start_is_not_held(self):
        self.assertEqual(self.climb({2, 4, 8}, missing={1}), (8, [1, 2, 4, 8, 15]))
        with self.assertRaises(lab.Missing):  # not "none is held"
            self.climb({}, missing={1, 2})


class Logs(unittest.TestCase):
    def test_events_of_one_channel_are_counted_and_the_cut_off_one_is_not(self):
        logger = script("measure/logger")

        def event(channel):
            return struct.pack(">IqqII", logger.SYNC, 0, 0, len(channel), 5) + channel + b"12345"

        data = event(logger.CHANNEL) + event(b"OTHER") + event(logger.CHANNEL)
        with tempfile.NamedTemporaryFile() as file:
            log = Path(file.name)
            log.write_bytes(data)
            self.assertEqual(logger.count(log), 2)
            log.write_bytes(data[:-1])
            self.assertEqual(logger.count(log), 1)


if __name__ == "__main__":
    unittest.main()
