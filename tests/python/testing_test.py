"""Benches of tmcl.testing, with and without their programs ($TMCL_BIN), and their fixture in pytest."""

import asyncio
import os
import pathlib
import subprocess
import tempfile
import time
import unittest
from unittest import mock

import tmcl.testing

STAGE = """\
[[module]]
model = "TMCM-1110"
address = 7
  [[module.axis]]
  motor = 0
  left_switch = -2000
"""
OF_A_READER = """\
def test_moves(tmcl_bench):
    d = tmcl_bench("TMCM-1110", unit="mm", screw_pitch=5)
    other = tmcl_bench("TMCM-1110", axes=["z"])
    d.x.move(0.5)
    d.x.wait()
    assert d.x.position == 0.5
    assert other.z.state().position_microsteps == 0

def test_moves_for_a_minute(tmcl_bench):
    d = tmcl_bench("TMCM-1110", virtual_time=True)
    d.x.rotate(internal=100)
    d.bench.run_for(60)
    assert d.x.state().position_microsteps > 100_000

def test_fails(tmcl_bench):
    d = tmcl_bench("TMCM-1110")
    d.x.move(microsteps=-5)
    assert d.x.wait().position_microsteps == 5
"""
# Debian's has the package python3-pytest.
PYTEST = ["/usr/bin/python3", "-m", "pytest", "-p", "tmcl.pytest_plugin", "-p", "no:cacheprovider"]


class TestingTest(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        # Where benches are, so that it is seen what they leave.
        self.enterContext(mock.patch.object(tempfile, "tempdir", str(self.folder)))

    def failure(self, *models, **how):
        with self.assertRaises(tmcl.Error) as raised:
            with tmcl.testing.bench(*models, **how):
                pass
        self.assertEqual(list(self.folder.iterdir()), [])
        return raised.exception

    def test_motors_are_axes_and_all_ends_with_the_block(self):
        with tmcl.testing.Bench("TMCM-3110", unit="mm", screw_pitch=5) as made:
            with made.connect() as d:
                self.assertEqual([axis.name for axis in d.axes()], ["x", "y", "z"])
                self.assertEqual(d.z.units().unit, "mm")
                d.x.move(0.5)
                self.assertEqual(d.x.wait().position, 0.5)
            daemon = made.daemon_pid
            self.assertIn("method=axis.move_to", made.log())
        self.assertFalse(pathlib.Path(f"/proc/{daemon}").exists())
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_axes_have_names_and_keys_of_their_own(self):
        axes = {"tilt": {"unit": "deg", "screw_pitch": 360}, "lift": {"soft_limits": [0, 20]}}
        with tmcl.testing.bench("TMCM-1110", "TMCM-1110@9", axes=axes, unit="mm", screw_pitch=5) as d:
            tilt, lift = d.rpc.axis_list().axes
            self.assertEqual((tilt.name, tilt.address, tilt.unit), ("tilt", 1, "deg"))
            self.assertEqual((lift.name, lift.address, lift.unit), ("lift", 9, "mm"))
            with self.assertRaises(tmcl.Error) as raised:
                d.lift.move(21)
            self.assertEqual(raised.exception.name, "beyond_soft_limit")

    def test_asyncio_has_its_socket(self):
        async def name(socket):
            async with await tmcl.aio.connect(socket) as d:
                return [axis.name for axis in await d.axes()]

        with tmcl.testing.Bench("TMCM-1110", axes=["w"]) as made:
            self.assertEqual(asyncio.run(name(made.socket)), ["w"])

    def test_the_simulator_takes_a_stage(self):
        (self.folder / "stage.toml").write_text(STAGE)
        options = ["--bench", str(self.folder / "stage.toml")]
        with tmcl.testing.bench(simulator=options, axes=["x"]) as d:
            self.assertEqual(d.rpc.axis_list().axes[0].address, 7)
            d.x.home(1)
            self.assertLess(abs(d.x.state().position_microsteps), 1000)
        (self.folder / "stage.toml").unlink()

    def test_a_missing_program_is_named_and_where_it_was_looked_for(self):
        with mock.patch.dict(os.environ, TMCL_BIN="/nowhere"):
            wrong = self.failure("TMCM-1110")
        self.assertEqual(wrong.name, "no_program")
        self.assertIn("no program tmclsim in /nowhere, which is $TMCL_BIN", wrong.message)
        with mock.patch.dict(os.environ, PATH="/nowhere"):
            del os.environ["TMCL_BIN"]
            wrong = self.failure("TMCM-1110")
        self.assertIn("no program tmclsim in the PATH", wrong.message)
        self.assertIn("apt install", wrong.hint)

    def test_what_a_program_refuses_is_told_in_its_words(self):
        wrong = self.failure("TMCM-3101")
        self.assertEqual(wrong.name, "bench_failed")
        self.assertIn("tmclsim has ended with 2: tmclsim: there is no module 'TMCM-3101'", wrong.message)
        wrong = self.failure("TMCM-1110", unit="mm", screw_pich=5)
        self.assertIn("unknown key 'screw_pich' in [[axis]]. Did you mean", wrong.message)
        self.assertEqual(self.failure("TMCM-1110", axes=["x", "y"]).name, "bad_argument")

    def test_a_daemon_that_is_killed_comes_back(self):
        with tmcl.testing.Bench("TMCM-1110") as made, made.connect() as d:
            made.stop_daemon(kill=True)
            made.start_daemon()
            self.assertEqual(d.x.state().position_microsteps, 0)

    def test_pytest_has_it_as_a_fixture_and_shows_the_log_of_a_failure(self):
        (self.folder / "test_reader.py").write_text(OF_A_READER)
        # It may be there already, by a package that is installed.
        environment = {**os.environ, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
        ran = subprocess.run([*PYTEST, self.folder], env=environment, capture_output=True, text=True)
        self.assertEqual(ran.returncode, 1, ran.stdout + ran.stderr)
        self.assertIn("1 failed, 2 passed", ran.stdout)
        self.assertIn("method=axis.move_to", ran.stdout[ran.stdout.index("stdout teardown"):])


class VirtualTimeTest(unittest.TestCase):
    """What takes a minute here takes milliseconds of the computer's time."""

    def bench(self, *models, **how):
        return self.enterContext(tmcl.testing.bench(*models, virtual_time=True, **how))

    def test_a_move_of_a_minute_arrives_when_it_was_predicted_to(self):
        d = self.bench("TMCM-3110", unit="mm", screw_pitch=5)
        d.x.set("max_velocity", in_unit="1 mm/s")
        began = d.bench.now
        started = d.x.move(60)
        self.assertGreater(started.predicted_s, 59)
        self.assertLess(d.x.position, 1)
        self.assertEqual(d.x.wait().position, 60)
        self.assertLess(abs(d.bench.now - began - started.predicted_s), 0.1)

    def test_time_stands_still_between_calls_and_passes_when_it_is_asked_for(self):
        d = self.bench("TMCM-1110")
        before = d.bench.now
        time.sleep(0.1)
        self.assertEqual(d.bench.now, before)
        d.bench.run_for(3600)
        self.assertEqual(d.bench.now, before + 3600)
        with self.assertRaises(tmcl.Error) as raised:
            d.bench.run_for(-1)
        self.assertEqual(raised.exception.name, "bad_argument")

    def trace(self):
        """All that a program hears in a script of a minute."""
        heard = []
        with tmcl.testing.bench("TMCM-3110", virtual_time=True, unit="mm", screw_pitch=5) as d:
            with d.record("x", "y") as recording:
                heard += [d.x.move(5), d.y.move(-4), d.x.wait()]
                d.bench.run_for(0.5)
                heard += [d.y.state(), d.x.move(-2), d.y.wait()]
                heard.append(d.x.state())  # behind all that was told before it
            d.x.rotate(internal=300)
            with self.assertRaises(tmcl.Error) as raised:
                d.x.wait(timeout=45)
            d.x.stop()
            d.bench.run_for(10)
            heard += [raised.exception.message, d.x.state(), d.bench.now]
        return heard, recording.states

    def test_the_same_script_hears_the_same_each_time(self):
        first, second = self.trace(), self.trace()
        self.assertGreater(len(first[1]), 30)
        self.assertEqual(first, second)

    def test_a_lease_runs_out_in_virtual_time_alone(self):
        d = self.bench("TMCM-1110")
        with self.assertRaises(tmcl.LeaseLost):
            with d.lease("x", ttl=0.2, by_hand=True) as lease:
                time.sleep(0.3)
                d.x.move(microsteps=200_000)
                d.x.wait()
                d.bench.run_for(0.15)
                lease.renew()
                d.bench.run_for(0.15)
                d.x.move(microsteps=0)
                d.bench.run_for(0.25)
                d.x.move(microsteps=100_000)
        d.bench.run_for(1)
        self.assertFalse(d.x.moving)
        self.assertGreater(d.x.state().position_microsteps, 0)

    def test_a_lease_is_renewed_while_time_passes(self):
        d = self.bench("TMCM-1110")
        with d.lease("x", ttl=0.2):
            d.x.rotate(internal=50)
            d.bench.run_for(30)
            self.assertTrue(d.x.moving)
            d.bench.run_for(0.1)
            self.assertAlmostEqual(d.bench.now, 30.1, delta=0.1)

    def test_an_axis_turns_until_its_client_goes(self):
        with tmcl.testing.Bench("TMCM-1110", virtual_time=True) as made, made.connect() as watching:
            with made.connect() as d:
                d.x.rotate(internal=100)
                made.run_for(10)
                self.assertTrue(watching.x.moving)
            made.run_for(1)
            self.assertFalse(watching.x.moving)

    def test_a_daemon_does_not_end_without_its_modules(self):
        with tmcl.testing.Bench("TMCM-1110", virtual_time=True) as made:
            for refused in (made.stop_daemon, made.start_daemon):
                with self.assertRaises(tmcl.Error) as raised:
                    refused()
                self.assertEqual(raised.exception.name, "not_in_this_time")
            self.assertTrue(pathlib.Path(f"/proc/{made.daemon_pid}").exists())
        with tmcl.testing.Bench("TMCM-1110") as made, self.assertRaises(tmcl.Error) as raised:
            made.run_for(1)
        self.assertIn("virtual_time=True", raised.exception.message)

    def test_what_is_wrong_is_told_in_the_words_of_the_program(self):
        with self.assertRaises(tmcl.Error) as raised:
            self.bench("TMCM-1110", unit="mm", screw_pich=5)
        self.assertIn("unknown key 'screw_pich'", raised.exception.message)

    def test_nothing_is_left_and_the_log_is_there(self):
        with tmcl.testing.Bench("TMCM-1110", virtual_time=True) as made:
            with made.connect() as d:
                d.x.move(microsteps=1)
            while "method=axis.move_to" not in made.log():  # another thread writes it
                time.sleep(0.01)
            process = made.daemon_pid
        self.assertFalse(pathlib.Path(f"/proc/{process}").exists())
        self.assertFalse(made.folder.exists())


if __name__ == "__main__":
    unittest.main()
