"""Stands in for mlzlog, which Debian has not: as much of it as Frappy's server asks for."""

from logging import DEBUG, ERROR, INFO, WARNING, Handler, Logger, StreamHandler, setLoggerClass

LOGLEVELS = {"debug": DEBUG, "info": INFO, "warning": WARNING, "error": ERROR}
ColoredConsoleHandler = StreamHandler


class LogfileHandler(Handler):
    """The console has it all."""

    def __init__(self, folder, name):
        super().__init__()

    def emit(self, record):
        pass


class MLZLogger(Logger):
    def getChild(self, suffix, ownDir=False):
        made = MLZLogger(f"{self.name}.{suffix}")
        made.parent = self
        return made
