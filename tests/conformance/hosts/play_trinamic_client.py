"""Plays a program in C that makes a process of each command: play_trinamic_client.py PLACE CHECKOUT FOLDER.

It asks drives 1 and 2, of which only the first is there, and waits 25 ms for each answer.
"""

import subprocess
import sys
from pathlib import Path

from checks import check, finish

COMMANDS = [
    ("GAP", "1,0,0"), ("SAP", "4,0,500"), ("GAP", "4,0,0"), ("MVP", "0,0,5000"), ("GAP", "3,0,0"),
    ("MST", "0,0,0"), ("ROR", "0,0,300"), ("ROL", "0,0,300"), ("MST", "0,0,0"), ("GGP", "66,0,0"),
    ("GGP", "53,2,0"), ("SGP", "53,2,7"), ("GGP", "53,2,0"), ("STGP", "53,2,0"), ("RSGP", "53,2,0"),
    ("STAP", "4,0,0"), ("RSAP", "4,0,0"), ("SIO", "0,2,1"), ("GIO", "0,0,0"),
]


def main():
    place, checkout, folder = sys.argv[1:4]
    # The program has its device's name built in.
    source = Path(checkout, "tri-prog.c").read_text().replace("/dev/stepper-drive", place)
    Path(folder, "tri.c").write_text(source)
    subprocess.run(["cc", "-w", "-o", f"{folder}/tri", f"{folder}/tri.c"], check=True)

    def answers(command, operands):
        run = subprocess.run(
            [f"{folder}/tri", "-d", "1-2", command, operands], capture_output=True, text=True, timeout=20
        )
        lines = [line for line in run.stdout.splitlines() if "Drive" in line]
        return ["Answered with OK" in lines[0], "Did not answer" in lines[1]] if len(lines) == 2 else run.stdout

    for number, (command, operands) in enumerate(COMMANDS):
        check(f"{number}: {command} {operands}", lambda: answers(command, operands), [True, True])
    finish()


main()
