"""YAML without guesses: every scalar arrives as text, and the model that receives it decides what it is.

So "1e-3" is a number where a number is expected, "no" stays a word, and a run called 007 keeps its zeros. A key without
a value (or with null) counts as not written. A key that is written twice is a fault; PyYAML would keep the last.
"""

from pathlib import Path
from typing import Any

import yaml


class YamlFault(Exception):  # noqa: N818  it never reaches a user: the reader makes a finding of it
    """A file that is no mapping in YAML; the message says what is wrong and in which line."""

    def __init__(self, message: str, remedy: str) -> None:
        self.remedy = remedy
        super().__init__(message)


class _Loader(yaml.BaseLoader):
    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen: set[str] = set()
        for key, _ in node.value:
            if not isinstance(key, yaml.ScalarNode):
                raise yaml.constructor.ConstructorError(None, None, "a key is no word", key.start_mark)
            if key.value in seen:
                raise yaml.constructor.ConstructorError(None, None, f"key {key.value!r} occurs twice", key.start_mark)
            seen.add(key.value)
        node.value = [(key, value) for key, value in node.value if not _is_null(value)]
        mapping: dict[Any, Any] = super().construct_mapping(node, deep)
        return mapping


class _Dumper(yaml.SafeDumper):
    """Puts strings with the rarer line breaks in quotes; PyYAML would write them bare and read them as spaces."""

    def represent_str(self, data: str) -> yaml.ScalarNode:
        style = '"' if set(data) & set("\x85\u2028\u2029") else None
        return self.represent_scalar("tag:yaml.org,2002:str", data, style)


_Dumper.add_representer(str, _Dumper.represent_str)


def _is_null(node: yaml.Node) -> bool:
    return isinstance(node, yaml.ScalarNode) and node.style is None and node.value in ("", "~", "null")


def load_yaml(path: Path) -> dict[str, Any]:
    """Read a mapping whose scalars are all `str`.

    Raises:
        YamlFault: The file cannot be read, is not UTF-8, not YAML, or not a mapping.
    """
    try:
        content = yaml.load(path.read_text(encoding="utf-8-sig"), _Loader)  # makes text, lists and mappings only
    except OSError as error:
        raise YamlFault(f"cannot be read: {error.strerror}", "put it there and make it readable") from error
    except UnicodeDecodeError as error:
        raise YamlFault(f"byte {error.start} is not UTF-8", "save it as UTF-8") from error
    except yaml.MarkedYAMLError as error:
        line = f"line {error.problem_mark.line + 1}: " if error.problem_mark else ""
        raise YamlFault(f"{line}not YAML: {error.problem}", "correct that line") from error
    except (yaml.YAMLError, RecursionError) as error:
        raise YamlFault(f"not YAML: {' '.join(str(error).split())}", "write plain `key: value` lines") from error
    if not isinstance(content, dict):
        raise YamlFault("is not a list of `key: value` lines", "begin with `format: 1`")
    return content


def dump_yaml(content: dict[str, object]) -> str:
    """Return a mapping as YAML, keys in their order."""
    text: str = yaml.dump(content, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=120)
    return text
