"""Errors a user can cause, each told in one line."""

from __future__ import annotations


class BadInput(Exception):
    """A user's input cannot be used: says what is wrong, where, and what was expected.

    Its text is one line, which the command line prints before it ends with exit status 2.
    """

    def __init__(self, where: str, what: str, expected: str = "") -> None:
        """Describes the mistake.

        Args:
            where: the file, option or field, for example `ward.yaml: places[3].yaw`.
            what: what was found there.
            expected: what would have been right; may be empty when `what` says it already.
        """
        self.where = where
        self.what = what
        self.expected = expected
        line = f"{where}: {what}" + (f"; expected {expected}" if expected else "")
        super().__init__(" ".join(line.split()))

    def __reduce__(self) -> tuple[type, tuple[str, str, str]]:
        return type(self), (self.where, self.what, self.expected)
