"""Damage is the same for the same random numbers, and never stumbles over what it damages."""

from __future__ import annotations

import copy
import json
import tomllib
from random import Random
from xml.etree import ElementTree

import pytest

from fuzz import documents, mutate_bytes, mutate_tree, texts
from fuzz.mutate_tree import Words
from fuzz.targets import deeply

WORDS = Words(("file", "shape"), ("box", "thing.obj"))


@pytest.mark.parametrize("raw", [b"", b"a", b"ply\nelement vertex 4\n0 1.5 -2\n" * 20])
def test_bytes_are_damaged_in_many_ways_and_alike_under_one_seed(raw):
    made = {mutate_bytes.damaged(raw, Random(seed), b"another file") for seed in range(300)}
    again = {mutate_bytes.damaged(raw, Random(seed), b"another file") for seed in range(300)}
    assert made == again
    assert len(made) > 30


def test_headers_are_damaged_more_often_than_what_follows():
    raw = bytes(10_000)
    first = 0
    for seed in range(200):
        made = mutate_bytes.damaged(raw, Random(seed))
        first += made[: mutate_bytes.HEADER_BYTES] != raw[: mutate_bytes.HEADER_BYTES]
    assert first > 80


def test_documents_are_damaged_in_keys_values_and_nesting():
    good = documents.scene_table()
    kinds = set()
    for seed in range(300):
        with deeply():
            made = mutate_tree.damaged(copy.deepcopy(good), Random(seed), WORDS)
            same = mutate_tree.damaged(copy.deepcopy(good), Random(seed), WORDS)
            assert repr(made) == repr(same)
        places, before = set(mutate_tree.walk(made)), set(mutate_tree.walk(good))
        kinds |= {"more"} if places - before else set()
        kinds |= {"less"} if before - places else set()
        kinds |= {"other"} if places == before else set()
    assert kinds == {"more", "less", "other"}


@pytest.mark.parametrize("seed", range(50))
def test_every_damaged_document_can_be_written(seed):
    random = Random(seed)
    with deeply():
        table = mutate_tree.damaged(documents.scene_table(), random, WORDS)
        assert isinstance(texts.toml_text(table), bytes)
        xml = mutate_tree.damaged(texts.xml_document(documents.XML), random, documents.XML_WORDS)
        assert texts.xml_text(xml).startswith(b"<")
        gltf = mutate_tree.damaged(documents.gltf()[0], random, documents.GLTF_WORDS)
        assert texts.json_text(gltf).startswith(b"{")


def test_good_documents_come_back_from_their_text():
    table = documents.scene_table()
    assert tomllib.loads(texts.toml_text(table).decode()) == table
    document = documents.gltf()[0]
    assert json.loads(texts.json_text(document)) == document
    tree = texts.xml_document(documents.XML)
    assert texts.xml_document(texts.xml_text(tree)) == tree
    assert ElementTree.fromstring(texts.xml_text(tree)).tag == "scene"


def test_odd_keys_texts_and_numbers_survive_toml():
    odd = {"a b": 1, "t": {"": 'q"\n\\', "n": 10**400, "z": float("inf")}, "l": [[1], [], {"k": 2}]}
    assert tomllib.loads(texts.toml_text(odd).decode()) == odd
