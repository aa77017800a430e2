"""Whatever of a world may be chosen together works together, in Python and in C: it has the same bits on one thread and
on three, whole and saved on the way, in either language; or a sentence refuses it, which the guide quotes.

A failure is a line that tries it again, which is also how one combination is tried:
`JOINTS='OPTION + OPTION' harness/python/check -k hold_together`. `JOINTS=all` tries each pair by itself too, and
`INSTA_UPDATE=always` writes the guide's table anew."""

import os
from collections import Counter
from itertools import combinations, permutations

import pytest
from conftest import ROOT
from joints import OPTIONS, InPython
from joints_in_c import NOT_IN_C, CError, InC, meaning

import bitgrain

PAGE = ROOT / "harness/guide/src/combinations.md"
BEGIN, END = "<!-- made by test_joints.py -->\n", "<!-- until here, by test_joints.py -->\n"
#: What stands in the table where a language refuses nothing.
NO_FAULT = TOGETHER, NO_FUNCTION = "go together", "no function"
ASKED = os.environ.get("JOINTS", "")
#: Each option's kind, in the order of the list.
KIND = {name: kind for kind, names in OPTIONS.items() for name in names}
PAIRS = [pair for pair in combinations(KIND, 2) if KIND[pair[0]] != KIND[pair[1]]]


def goes(world, loads):
    """Steps a world, which is edited and saved on the way, and goes on from its bytes where it `loads` them; returns
    its last digest and all bytes."""
    saved = []

    def halt():
        saved.append(world.save())
        if loads:
            world.load()

    world.step(10)
    if world.take["added"]:
        world.add_obstacle()
    world.step(10)
    if world.take["save"]:
        halt()
    world.edit()
    world.step(20)
    halt()
    world.step(20)
    return world.digest(), saved


def asked(names):
    """What Python refuses these options with, and C; `None` of a language in which they go together, in which case all
    ends are one."""
    chosen = {KIND[name]: name for name in names}
    refused, ends = [None, None], {}
    for threads, loads in ((1, False), (3, True)):
        try:
            world = InPython(chosen, threads)
            ends[f"Python on {threads}"] = goes(world, loads)
            assert world.leaves() == (world.world.ids[0] > 1), "a grain is to leave"
        except bitgrain.Error as error:
            refused[0] = str(error)
    if not NOT_IN_C.intersection(names):
        try:
            if refused[0]:
                ends["C, not loaded"] = goes(InC(chosen), False)
            ends["C"] = goes(InC(chosen), True)
        except CError as error:
            refused[1] = str(error)
    for which, what in enumerate(["digest", "bytes"]):
        for way, end in ends.items():
            assert end[which] == next(iter(ends.values()))[which], f"{way} has another {what} than {next(iter(ends))}"
    return tuple(refused)


def holds(names):
    """Tries options that are meant to go together."""
    try:
        wrong = [why for why in asked(names) if why]
    except Exception as error:
        wrong = [f"{type(error).__name__}: {error}".splitlines()[0]]
    if wrong:
        line = f"JOINTS='{' + '.join(names)}' harness/python/check -k hold_together"
        pytest.fail(f"{wrong[0]}: {line}", pytrace=False)


def rows(text):
    """The pairs that the guide's table refuses, with what says so in each language."""
    found = {}
    for line in text.splitlines():
        if line.startswith("| ") and not line.startswith(("| option", "| ---")):
            ours, others, *why = [cell.strip() for cell in line.strip("|").split(" | ")]
            why = tuple(None if word in NO_FAULT else word.strip("`") for word in why)
            for pair in [(a, b) for a in ours.split("; ") for b in others.split("; ")]:
                found[tuple(sorted(pair, key=list(KIND).index))] = why
    return {pair: found[pair] for pair in PAIRS if pair in found}


def table(refused):
    """The part of the guide that these refusals make."""
    in_c = [pair for pair in PAIRS if not NOT_IN_C.intersection(pair)]
    not_in_c = [pair for pair in in_c if refused.get(pair, (None, None))[1]]
    python = [pair for pair, why in refused.items() if why[0]]
    lines = [
        f"Of {len(PAIRS)} pairs of the {len(KIND)} options below Python takes {len(PAIRS) - len(python)} and refuses "
        f"{len(python)}. C has functions for",
        f"{len(in_c)} of them; it takes {len(in_c) - len(not_in_c)} and refuses {len(not_in_c)}.",
        "",
        "| option | not with | because, in Python | in C |",
        "| --- | --- | --- | --- |",
    ]
    # The option that is refused more often has the row; options that are refused alike share one.
    often = Counter(name for pair in refused for name in pair)
    one, alike = {}, {}
    for pair, (in_python, by_c) in refused.items():
        name, other = sorted(pair, key=lambda name: -often[name])
        without = NO_FUNCTION if NOT_IN_C.intersection(pair) else TOGETHER
        why = (in_python or TOGETHER, f"`{by_c}`" if by_c else without)
        one.setdefault((name, why), []).append(other)
    for (name, why), others in one.items():
        alike.setdefault((tuple(others), why), []).append(name)
    for (others, why), names in alike.items():
        lines.append(" | ".join(["| " + "; ".join(names), "; ".join(others), *why]) + " |")
    named = sorted({why[1] for why in refused.values() if why[1]})
    lines += ["", *[f"* `{name}`: {meaning(name)}" for name in named]]
    lines += ["", *["* " + "; ".join(names) for names in OPTIONS.values()]]
    return "\n".join(lines) + "\n"


def written():
    head, rest = PAGE.read_text().split(BEGIN)
    made, tail = rest.split(END)
    return head, made, tail


REFUSED = rows(written()[1])


def covering():
    """Combinations that hold every pair which is not refused: each begins with a pair that is in none yet, and takes of
    each kind the option that brings most new pairs. Pairs that C has functions for are in one that it has them for."""
    left = {pair for pair in PAIRS if pair not in REFUSED}
    while left:
        first = min(left, key=lambda pair: (bool(NOT_IN_C.intersection(pair)), PAIRS.index(pair)))
        names = list(first)
        for kind, options in OPTIONS.items():
            if kind in [KIND[name] for name in names]:
                continue

            def pairs(one):
                return [pair for name in names for pair in permutations((one, name))]

            options = [one for one in options if one not in NOT_IN_C or NOT_IN_C.intersection(first)]
            options = [one for one in options if not REFUSED.keys() & pairs(one)]
            names.append(max(options, key=lambda one: len(left.intersection(pairs(one)))))
        names.sort(key=list(KIND).index)
        left.difference_update(combinations(names, 2))
        yield tuple(names)


def combinations_to_try():
    if ASKED not in ("", "all"):
        return [tuple(ASKED.split(" + "))]
    return [*covering(), *(pair for pair in PAIRS if ASKED == "all" and pair not in REFUSED)]


@pytest.mark.parametrize("names", combinations_to_try(), ids=" + ".join)
def test_options_hold_together(names):
    holds(names)


@pytest.mark.parametrize("pair", REFUSED, ids=" + ".join)
def test_what_is_refused_is_refused_by_a_sentence(pair):
    assert asked(pair) == REFUSED[pair]


def test_the_guide_says_what_is_refused():
    head, made, tail = written()
    refused = REFUSED
    if os.environ.get("INSTA_UPDATE") == "always":
        refused = {pair: why for pair in PAIRS for why in [asked(pair)] if any(why)}
        made = table(refused)
        PAGE.write_text(head + BEGIN + made + END + tail)
    assert made == table(refused)


@pytest.mark.parametrize("shape", OPTIONS["shape"])
def test_grains_touch_each_obstacle(shape):
    world = InPython({"shape": shape}, 1).world
    world.step()
    assert world.obstacles[1].force.any()
