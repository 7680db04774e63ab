"""Uploads a firmware with PyTrinamic's own tool, and asks the module what it runs then.

    firmware.py MODEL --interface ... --port ...

The firmware is nonsense of some pages with a gap, and with a version in it. Needs python3-intelhex.
"""

import sys
import tempfile
import time

import intelhex
from pytrinamic.cli import tmclfwupload
from pytrinamic.connections import ConnectionManager

START = 0x4000
SECOND_PART = START + 0x1234
RESTART_S = 1.0


def firmware(number):
    version = f"{int(number):04}V142".encode()
    image = intelhex.IntelHex()
    image.puts(START, bytes(0x80 + i % 0x77 for i in range(3001)) + version)
    image.puts(SECOND_PART, bytes(0x80 + i % 0x71 for i in range(999)))
    return image, version.decode()


def main():
    model, *options = sys.argv[1:]
    image, version = firmware(model.split("-")[1])
    with tempfile.NamedTemporaryFile("w", suffix=".hex") as file:
        image.write_hex_file(file)
        file.flush()
        # The tool reads how to connect from the command line itself.
        sys.argv = ["tmclfwupload", file.name, *options]
        failed = tmclfwupload.main(sys.argv[1:])
    if failed:
        sys.exit("the upload failed")
    time.sleep(RESTART_S)
    with ConnectionManager(options).connect() as interface:
        found = interface.get_version_string()
    # Seven bytes fit into a CAN frame of seven.
    if not version.startswith(found) or len(found) < 7:
        sys.exit(f"the module tells {found}, not {version}")
    print(f"the module runs {found}")


if __name__ == "__main__":
    main()
