"""What this package raises; each says what was found and what to do about it."""


class Error(Exception):
    """It cannot be done as asked: a rig file, a key, a network or a log that is wrong."""


class Refused(Error):
    """The owner of the rig refuses a request; the text is its own."""


class NoAnswer(Error):
    """No owner is heard, or it does not answer."""
