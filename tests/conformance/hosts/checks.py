"""What a script that plays a host has in common: checks with a name, and an exit status."""

import sys
import time
import traceback

failed = []
carried_out = []


def check(name, action, expected=None):
    """Carries out an action; `expected` is a value, a function that judges one, or None: it must not raise."""
    carried_out.append(name)
    try:
        seen = action()
        right = expected is None or (expected(seen) if callable(expected) else seen == expected)
    except Exception as error:
        seen, right = f"{type(error).__name__}: {error}", False
    if not right:
        failed.append(name)
        print(f"  FAILED {name}: {seen}", flush=True)


def near(value, tolerance):
    return lambda seen: abs(seen - value) <= tolerance


def until(condition, seconds=30):
    """Asks again until the condition holds; false if it never does."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.05)
    return True


def finish():
    print(f"{len(carried_out) - len(failed)} of {len(carried_out)} checks are right", flush=True)
    sys.exit(1 if failed or not carried_out else 0)


def crashed():
    traceback.print_exc()
    sys.exit(1)
