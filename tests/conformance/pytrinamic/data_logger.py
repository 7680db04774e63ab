"""Records a ramp with PyTrinamic's RAMDebug and with its DataLogger, and looks at every sample.

    data_logger.py MODEL --interface ... --port ...

Of a module whose ramp counts in microsteps a second.
"""

import importlib
import sys
import time

from pytrinamic.connections import ConnectionManager

POSITION, VELOCITY = 1, 3
SPEED = 10_000
THRESHOLD = 1000
BUFFER = 8192
FACTORS = (4, 8, 16, 128)
RAMP_S = 1.5
# The first of PyTrinamic's modules must come before these: they import each other.
modules = importlib.import_module("pytrinamic.modules")
ram_debug = importlib.import_module("pytrinamic.RAMDebug")
DataLogger = importlib.import_module("pytrinamic.datalogger").DataLogger


def want(condition, sentence):
    if not condition:
        sys.exit(sentence)


def passes(speeds, first_after):
    return speeds[first_after - 1] <= THRESHOLD < speeds[first_after]


def record_start(interface, motor):
    """RAMDebug: a rising speed, with a part from before it."""
    logger = ram_debug.RAMDebug(interface)
    velocity = ram_debug.Channel.axis_parameter(0, VELOCITY)
    logger.set_channel(ram_debug.Channel.axis_parameter(0, POSITION))
    logger.set_channel(velocity)
    logger.set_sample_count(500)
    logger.set_pretrigger_samples(100)
    logger.set_trigger(velocity, ram_debug.RAMDebug_Trigger.TRIGGER_RISING_EDGE_SIGNED, THRESHOLD)
    logger.start_measurement()
    while logger.is_pretriggering():
        pass
    motor.rotate(SPEED)
    while not logger.is_measurement_done():
        pass
    positions, speeds = logger.get_samples()
    want(len(positions) == 500 and positions == sorted(positions), "the position goes back")
    want(passes(speeds, 100), f"the trigger came at {speeds[99:101]}")


def log(interface, factor, samples, trigger=None):
    logger = DataLogger(interface, 1)
    logger.config.samples_per_channel = samples
    logger.config.log_data = {"position": DataLogger.DataTypeAp(POSITION, 0, signed=True)}
    if samples < BUFFER:
        logger.config.log_data["speed"] = DataLogger.DataTypeAp(VELOCITY, 0, signed=True)
    logger.config.down_sampling_factor = factor
    logger.config.trigger = trigger
    return logger


def finish(logger):
    logger.wait_for_capture_completion(60)
    logger.download_log()
    return {name: channel.samples for name, channel in logger.log.data.items()}


def record_turning(interface, factor, samples):
    """DataLogger: at a constant speed, all samples are the same way apart."""
    logger = log(interface, factor, samples)
    logger.start_capture()
    positions = finish(logger)["position"]
    way = SPEED * factor / logger.log.base_frequency_hz
    ways = [after - before for before, after in zip(positions, positions[1:])]
    want(len(positions) == samples, f"{len(positions)} samples, not {samples}")
    want(all(abs(one - way) <= 1 for one in ways), f"{min(ways)}..{max(ways)}, not {way} apart")


def record_edge(interface, change, edge):
    trigger = DataLogger.Config.Trigger(
        on_data=DataLogger.DataTypeAp(VELOCITY, 0, signed=True),
        threshold=THRESHOLD,
        edge=edge,
        pretrigger_samples_per_channel=20,
    )
    logger = log(interface, 1, 100, trigger)
    logger.start_capture()
    logger.wait_for_pretrigger_completion()
    want(not logger.has_triggered(), "triggered before anything happened")
    change()
    speeds = finish(logger)["speed"]
    if edge == DataLogger.TriggerEdge.FALLING:
        speeds = [2 * THRESHOLD - speed for speed in speeds]
    want(passes(speeds, 20) or speeds[20] == THRESHOLD, f"the trigger came at {speeds[19:21]}")


def main():
    model, *options = sys.argv[1:]
    with ConnectionManager(options).connect() as interface:
        motor = getattr(modules, model.replace("-", ""))(interface).motors[0]
        record_start(interface, motor)
        time.sleep(RAMP_S)
        for factor in FACTORS:
            record_turning(interface, factor, 40)
        record_turning(interface, 1, BUFFER)
        record_edge(interface, motor.stop, DataLogger.TriggerEdge.FALLING)
        time.sleep(RAMP_S)
        record_edge(interface, lambda: motor.rotate(SPEED), DataLogger.TriggerEdge.RISING)
        motor.stop()
    print(f"recorded with 1 to {max(FACTORS)} ticks a sample, and {BUFFER} samples at once")


if __name__ == "__main__":
    main()
