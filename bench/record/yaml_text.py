"""YAML without guesses: every scalar arrives as text, and the model that receives it decides what it is.

So "1e-3" is a number where a number is expected, "no" stays a word, and a run called 007 keeps its zeros. A key without
a value (or with null) counts as not written, but for a name that the user lists (a quantity, a column), which lacks
its value. A key that is written twice is a fault; PyYAML would keep the last. So is a type written before a value that
is not of it, or of which nothing is known here (!!set, !x).

Robots and scenarios are read with PyYAML's own types (`load_typed_yaml`), less what YAML 1.1 takes for numbers and
people do not: 1:30 is ninety there, 010 eight. Both ways have the limits of `bench.record.limits`: bytes, levels, and
values with aliases written out.
"""

import re
from collections.abc import Collection
from math import inf
from pathlib import Path
from typing import Any

import yaml

from bench.record.limits import YAML_BYTES, YAML_DEPTH, YAML_VALUES, Limit
from bench.record.plain_file import FileFault, read_plain

LONGEST_NUMBER = 100  # characters; 17 digits are all that a number keeps, and PyYAML is slow with thousands
TAG = "tag:yaml.org,2002:"
BOOL, INT, FLOAT, STR, TIMESTAMP = (f"{TAG}{name}" for name in ("bool", "int", "float", "str", "timestamp"))
SEQ, MAP, NULL = (f"{TAG}{name}" for name in ("seq", "map", "null"))
PLAIN_TYPES = {yaml.ScalarNode: (STR, BOOL, INT, FLOAT, TIMESTAMP, NULL), yaml.SequenceNode: (SEQ,)}
DECIMAL = re.compile(r"[-+]?((0|[1-9]\d*)|(\d+\.\d*|\.\d+)([eE][-+]?\d+)?|\.(inf|Inf|INF))|\.(nan|NaN|NAN)", re.ASCII)
_TYPES = yaml.resolver.Resolver()
_PARTED = re.compile(r"[-+]?\d[\d_]*_[\d_]*(\.[\d_]*)?([eE][-+]?[\d_]+)?", re.ASCII)  # pydantic reads 1_0e1 as 100
_LED_BY_ZERO = re.compile(r"[-+]?0\d", re.ASCII)


def is_odd(text: str) -> bool:
    """Whether a number is written with 0 in front or _ between digits, which not all programs read alike."""
    return bool(_PARTED.fullmatch(text.strip()) or _LED_BY_ZERO.match(text.strip()))


class YamlFault(Exception):  # noqa: N818  it never reaches a user: the reader makes a finding of it
    """A file that is no mapping in YAML; the message says what is wrong and in which line."""

    def __init__(self, message: str, remedy: str) -> None:
        self.remedy = remedy
        super().__init__(message)


class _RefusedError(yaml.MarkedYAMLError):
    """It is YAML, and not read all the same."""

    def __init__(self, problem: str, remedy: str, mark: yaml.Mark) -> None:
        self.remedy = remedy
        super().__init__(problem=problem, problem_mark=mark)


class _LimitError(_RefusedError):
    """A limit was reached."""

    def __init__(self, limit: Limit, mark: yaml.Mark) -> None:
        super().__init__(f"more than {limit}", limit.remedy, mark)


class _Guarded(yaml.parser.Parser, yaml.composer.Composer):
    """Composes no key twice, nothing too deep, and no more than the limit with all aliases written out."""

    def __init__(self, stream: str) -> None:
        super().__init__(stream)  # type: ignore[call-arg]  # of the loader that it is mixed into
        self._depth = self._composed = 0
        self._sizes: dict[int, int] = {}  # of composed nodes, with their aliases written out

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        is_alias, mark = self.check_event(yaml.AliasEvent), self.peek_event().start_mark  # type: ignore[no-untyped-call]
        self._depth += 1
        self._composed += 1
        for limit, found in ((YAML_DEPTH, self._depth), (YAML_VALUES, self._composed)):
            if limit.exceeded(found):
                raise _LimitError(limit, mark)
        node = super().compose_node(parent, index)
        self._depth -= 1
        if is_alias and id(node) not in self._sizes:
            raise yaml.composer.ComposerError(None, None, "an alias stands within what it stands for", mark)
        if not is_alias:
            self._sizes[id(node)] = 1 + sum(self._sizes[id(part)] for part in _parts(node))
        if YAML_VALUES.exceeded(self._sizes[id(node)]):
            raise _LimitError(YAML_VALUES, mark)
        return node

    def compose_scalar_node(self, anchor: Any) -> yaml.ScalarNode:
        node: yaml.ScalarNode = super().compose_scalar_node(anchor)
        if any("\ud800" <= character <= "\udfff" for character in node.value):  # written as an escape; half of a pair
            problem = "half of a surrogate pair is no character"
            raise yaml.constructor.ConstructorError(None, None, problem, node.start_mark)
        return node

    def compose_mapping_node(self, anchor: Any) -> yaml.MappingNode:
        node: yaml.MappingNode = super().compose_mapping_node(anchor)
        seen: set[str] = set()
        for key, _ in node.value:
            if not isinstance(key, yaml.ScalarNode):
                raise yaml.constructor.ConstructorError(None, None, "a key is no word", key.start_mark)
            if key.value in seen:
                raise yaml.constructor.ConstructorError(None, None, f"key {key.value!r} occurs twice", key.start_mark)
            seen.add(key.value)
        return node


def _parts(node: yaml.Node | None) -> list[yaml.Node]:
    if isinstance(node, yaml.MappingNode):
        return [part for pair in node.value for part in pair]
    return list(node.value) if isinstance(node, yaml.SequenceNode) else []


def _is_of_its_tag(node: yaml.Node) -> bool:
    """Whether a scalar before which its type is written, as in !!int 5, is one; without it, it has that of its form."""
    if node.tag not in (BOOL, INT, FLOAT, TIMESTAMP, NULL):
        return True
    plain = _TYPES.resolve(yaml.ScalarNode, node.value, (True, False))  # type: ignore[no-untyped-call]
    return bool(plain == node.tag) or (node.tag, plain) == (FLOAT, INT)


class _Loader(_Guarded, yaml.BaseLoader):
    listing: Collection[str] = ()  # keys whose mappings have names of the user's own

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        node = super().compose_node(parent, index)
        if node is not None and not (node.tag in PLAIN_TYPES.get(type(node), (MAP,)) and _is_of_its_tag(node)):
            value = f"{node.value!r} is no" if isinstance(node, yaml.ScalarNode) else "a list of values is no"
            problem = f"{value} {node.tag.replace(TAG, '!!')} that is read"
            raise _RefusedError(problem, "write the value alone, without a type before it", node.start_mark)
        if isinstance(parent, yaml.MappingNode) and isinstance(index, yaml.ScalarNode) and index.value in self.listing:
            for name, value in node.value if isinstance(node, yaml.MappingNode) else ():
                if _is_null(value):
                    remedy = "write its value, or remove it"
                    raise _RefusedError(f"{index.value}.{name.value} has no value", remedy, name.start_mark)
        return node

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        node.value = [(key, value) for key, value in node.value if not _is_null(value)]
        mapping: dict[Any, Any] = super().construct_mapping(node, deep)
        return mapping


class _TypedLoader(_Guarded, yaml.SafeLoader):
    """Leaves `true` and `yes` as words: where one is expected they are understood, and they are no number 1."""

    yaml_implicit_resolvers = {  # noqa: RUF012  as PyYAML has it
        first: [(tag, pattern) for tag, pattern in found if tag != BOOL]
        for first, found in yaml.SafeLoader.yaml_implicit_resolvers.items()
    }

    def compose_scalar_node(self, anchor: Any) -> yaml.ScalarNode:
        node: yaml.ScalarNode = super().compose_scalar_node(anchor)
        if len(node.value) > LONGEST_NUMBER and node.tag != STR:
            problem = f"{node.value[:20]!r}... is no number of up to {LONGEST_NUMBER} characters"
            raise yaml.constructor.ConstructorError(None, None, problem, node.start_mark)
        if not _is_of_its_tag(node):
            problem = f"{node.value!r} is no !!{node.tag.removeprefix(TAG)}"
            raise yaml.constructor.ConstructorError(None, None, problem, node.start_mark)
        is_number = node.style is None and (node.tag in (INT, FLOAT) or _PARTED.fullmatch(node.value))
        if is_number and not DECIMAL.fullmatch(node.value):
            remedy = "write a number in decimal digits without 0 in front or _ between them, and a name in quotes"
            raise _RefusedError(f"{node.value!r} is no decimal number", remedy, node.start_mark)
        return node


class _Dumper(yaml.SafeDumper):
    """Puts strings with the rarer line breaks in quotes; PyYAML would write them bare and read them as spaces."""

    def represent_str(self, data: str) -> yaml.ScalarNode:
        style = '"' if set(data) & set("\x85\u2028\u2029") else None
        return self.represent_scalar("tag:yaml.org,2002:str", data, style)


_Dumper.add_representer(str, _Dumper.represent_str)


def _is_null(node: yaml.Node) -> bool:
    return isinstance(node, yaml.ScalarNode) and node.style is None and node.value in ("", "~", "null")


def load_yaml(path: Path, listing: Collection[str] = ()) -> dict[str, Any]:
    """Read a mapping whose scalars are all `str`.

    Args:
        path: Of the file.
        listing: Keys whose mappings list names of the user's own, each of which needs a value.

    Raises:
        YamlFault: The file cannot be read, is not UTF-8, not YAML, or not a mapping; or it exceeds a limit.
    """
    return _loaded(path, type("_Listing", (_Loader,), {"listing": listing}))


def load_typed_yaml(path: Path) -> dict[str, Any]:
    """Read a mapping whose scalars are what PyYAML takes them for: numbers, words, dates, true and false.

    Raises:
        YamlFault: As `load_yaml`.
    """
    return _loaded(path, _TypedLoader)


def _loaded(path: Path, loader: type[_Loader] | type[_TypedLoader]) -> dict[str, Any]:
    try:
        content = yaml.load(read_plain(path, YAML_BYTES).decode("utf-8-sig"), loader)  # text, numbers, lists, mappings
    except FileFault as fault:
        raise YamlFault(str(fault), fault.remedy) from fault
    except UnicodeDecodeError as error:
        raise YamlFault(f"byte {error.start} is not UTF-8", "save it as UTF-8") from error
    except yaml.MarkedYAMLError as error:
        line = f"line {error.problem_mark.line + 1}: " if error.problem_mark else ""
        if isinstance(error, _RefusedError):
            raise YamlFault(f"{line}{error.problem}", error.remedy) from error
        raise YamlFault(f"{line}not YAML: {error.problem}", "correct that line") from error
    except (yaml.YAMLError, RecursionError, ValueError) as error:  # ValueError: a date such as 2024-99-99
        raise YamlFault(f"not YAML: {' '.join(str(error).split())}", "write plain `key: value` lines") from error
    if not isinstance(content, dict):
        raise YamlFault("is not a list of `key: value` lines", "write one such line for each key")
    return content


def dump_yaml(content: dict[str, object]) -> str:
    """Return a mapping as YAML, keys in their order."""
    text: str = yaml.dump(content, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=120)
    return text


def in_quotes(text: str) -> str:
    """Return a text as YAML has it in double quotes, on one line; escaped as YAML reads it, which JSON's are not."""
    dumped: str = yaml.safe_dump(text, default_style='"', allow_unicode=True, width=inf)
    return dumped.rstrip("\n")
