"""What all validated configuration has in common, and how a file of it is read."""

from collections.abc import Collection
from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from bench.errors import BenchError
from bench.record.schema_words import faults_of, words_of
from bench.record.yaml_text import YamlFault, load_yaml

Model = TypeVar("Model", bound=BaseModel)


class Strict(BaseModel):
    """Unknown keys are errors, values do not change after construction."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


def read_as(model: type[Model], path: Path, refused: type[BenchError], listing: Collection[str] = ()) -> Model:
    """Read a YAML file as a model; `listing` as of `load_yaml`.

    Raises:
        BenchError: Of the kind `refused`: it cannot be read or breaks the model; every fault with its place.
    """
    try:
        return model.model_validate(load_yaml(path, listing))
    except YamlFault as fault:
        raise refused(f"{path}: {fault}; {fault.remedy}") from fault
    except ValidationError as error:
        places = ((".".join(map(str, one["loc"])) or "top level", words_of(one, model)) for one in faults_of(error))
        raise refused(f"{path}: {place}: {words}" for place, words in places) from error
