"""What a verb came to: its document, as attributes and arrays."""
import copy
import html

import numpy as np


def _value(value):
    """A dictionary as a Part, a list of numbers as an array that cannot be written to, in which none is NaN."""
    if isinstance(value, dict):
        return Part(value)
    if isinstance(value, list):
        numbers = [one for one in value if one is not None]
        if numbers and all(isinstance(one, (int, float)) and not isinstance(one, bool) for one in numbers):
            whole = len(numbers) == len(value) and all(isinstance(one, int) for one in numbers)
            array = np.array([np.nan if one is None else one for one in value], dtype=np.int64 if whole else float)
            array.flags.writeable = False
            return array
        if value and all(isinstance(one, list) for one in value) and len({len(one) for one in value}) == 1:
            rows = [_value(one) for one in value]
            if all(isinstance(row, np.ndarray) for row in rows):
                array = np.stack(rows)
                array.flags.writeable = False
                return array
        return tuple(_value(one) for one in value)
    return value


class Part:
    """A part of a document: keys are attributes. Frozen."""

    __slots__ = ("_document", "_kept")

    def __init__(self, document):
        object.__setattr__(self, "_document", document)
        object.__setattr__(self, "_kept", {})

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            value = self._document[name]
        except KeyError:
            raise AttributeError(f"the document has no {name}; it has {', '.join(self._document)}") from None
        if name not in self._kept:
            self._kept[name] = _value(value)
        return self._kept[name]

    def __setattr__(self, name, value):
        raise AttributeError("results are frozen; to_dict() gives a copy to change")

    def __getitem__(self, name):
        return self.__getattr__(name)

    def __contains__(self, name):
        return name in self._document

    def __iter__(self):
        return iter(self._document)

    def __dir__(self):
        return [*super().__dir__(), *self._document]

    def __eq__(self, other):
        return isinstance(other, Part) and self._document == other._document

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self):
        return type(self), (self._document,)

    def to_dict(self):
        """The JSON document, as a copy that may be changed.

        Returns
        -------
        dict
        """
        return copy.deepcopy(self._document)

    def to_pandas(self, key):
        """A list of the document as a table of pandas, a row an entry.

        Parameters
        ----------
        key : str
            of the list: "limit"

        Returns
        -------
        pandas.DataFrame
        """
        import pandas

        return pandas.DataFrame(self._document[key])

    def __repr__(self):
        return f"{type(self).__name__}({', '.join(self._document)})"


class Result(Part):
    """A verb's document, with its summary, and why its answer was not reached where it was not.

    Keys are attributes; tables within are read in the same way, lists of numbers are arrays, in which `null` is NaN. Frozen.
    `key in result` and `result[key]` work as of a dict.
    """

    __slots__ = ("_summary", "_shortfall", "_page")

    def __init__(self, document, summary="", shortfall="", page=None):
        super().__init__(document)
        object.__setattr__(self, "_summary", summary)
        object.__setattr__(self, "_shortfall", shortfall)
        object.__setattr__(self, "_page", page)

    @property
    def summary(self):
        """In lines of text, as the command line prints it."""
        return self._summary

    @property
    def shortfall(self):
        """Why the answer was not reached (the command line's exit code 3); empty: it was."""
        return self._shortfall

    def __reduce__(self):
        return type(self), (self._document, self._summary, self._shortfall)

    def page(self):
        """The page with the result's figures: HTML that opens offline. A notebook shows it (`_repr_html_`).

        Returns
        -------
        str

        Raises
        ------
        ValueError
            if this is no verb's own result: it came out of a pickle
        """
        if self._page is None:
            raise ValueError("this result has no page; a verb's own result has")
        return self._page()

    def __repr__(self):
        state = f" not reached: {self._shortfall}" if self._shortfall else ""
        return f"<robomill {self._document.get('document', 'result')}{state}; {', '.join(self._document)}>"

    def _repr_html_(self):
        if self._page is None:
            return f"<pre>{html.escape(self._summary)}</pre>"
        return f'<iframe srcdoc="{html.escape(self.page())}" style="width:100%;height:720px;border:0"></iframe>'
