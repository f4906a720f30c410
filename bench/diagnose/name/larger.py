"""Whether causes that are larger than plausible are worth fitting where something is unlisted."""

from dataclasses import replace

from bench.diagnose.linearise.candidates import LARGER
from bench.diagnose.name.leaders import GROWING, stands_in_for
from bench.diagnose.name.naming import Naming
from bench.diagnose.name.search import search
from bench.diagnose.name.search_space import SearchSpace, search_space
from bench.diagnose.name.subset_posterior import SubsetPosterior


def may_be_larger(naming: Naming) -> bool:
    """Whether larger causes than are plausible may explain what a naming calls unlisted, or all, if it has nothing.

    They have to explain the greater part of it in the linearised model. That does not show plays, for where a link
    rests within one is chance: of these one that a fit wanted larger will do.
    """
    if naming.unlisted is None or naming.plays_beyond:
        return True
    about = search_space(naming.linear, naming.tried, naming.screening.threshold, naming.models[0])
    return explains_unlisted(about, LARGER)


def explains_unlisted(about: SearchSpace, reach: float) -> bool:
    """Whether listed causes may explain the greater part of what the free shape of a model does.

    Args:
        about: The model, with a free shape.
        reach: Times what is plausible, that the causes go up to.
    """
    terms = [replace(term, prior=reach * term.prior) if term.is_listed else term for term in about.model.terms]
    model = SubsetPosterior(about.model.information, about.model.scores, terms)
    alone = tuple(i for i in about.present if i not in about.shape)
    return stands_in_for(model, search(model, [alone], expanded=GROWING)[0], alone, about.present)
