"""A tiny Whisper model that says planted words, whatever it hears: no download, real software.

The decoder's layers do nothing; the vector of each position is that of the token which is to come
out there, so that the library's own search finds the planted row of tokens.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

DEPTH = 128  # numbers a token
MELS = 80
POSITIONS = 448
SHARPNESS = 30.0  # of the planted token against the one that was said before


def plant(folder: Path, text: str, end: float) -> Path:
    """Write a model, of English alone, that hears `text` from 0 to `end` s of every recording."""
    from ctranslate2.specs import WhisperSpec

    folder.mkdir(parents=True)
    tokens = _tokenizer(folder, text)
    rows = ["<|0.00|>", *_pieces(text), f"<|{end:.2f}|>", "<|endoftext|>"]
    spec = WhisperSpec(1, 2, 1, 2)
    random = np.random.default_rng(0)
    vectors = random.standard_normal((len(tokens), DEPTH)).astype(np.float32)
    vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)
    _encoder(spec.encoder)
    _decoder(spec.decoder, vectors, [tokens[name] for name in rows])
    languages = [place for name, place in tokens.items() if name in _LANGUAGES]
    spec.config.lang_ids = languages
    spec.config.suppress_ids = []
    spec.config.suppress_ids_begin = []
    spec.config.alignment_heads = [(0, 0)]
    spec.register_vocabulary(list(tokens))
    spec.validate()
    spec.save(str(folder))
    return folder


_LANGUAGES = ("<|en|>",)


def _pieces(text: str) -> list[str]:
    return [f"Ġ{word}" for word in text.split()]


def _tokenizer(folder: Path, text: str) -> dict[str, int]:
    """Words, letters and Whisper's own tokens, in the file that the library reads."""
    from faster_whisper.tokenizer import _LANGUAGE_CODES
    from tokenizers import Tokenizer, decoders, models, pre_tokenizers

    vocabulary = {letter: i for i, letter in enumerate(sorted(pre_tokenizers.ByteLevel.alphabet()))}
    merges = []
    for piece in _pieces(text):
        known = piece[0]
        for letter in piece[1:]:
            if known + letter not in vocabulary:
                merges.append((known, letter))
                vocabulary[known + letter] = len(vocabulary)
            known += letter
    tokenizer = Tokenizer(models.BPE(vocab=vocabulary, merges=merges))
    tokenizer.pre_tokenizer = pre_tokenizers.ByteLevel(add_prefix_space=False)
    tokenizer.decoder = decoders.ByteLevel()
    special = ["<|endoftext|>", "<|startoftranscript|>"]
    special += [f"<|{code}|>" for code in _LANGUAGE_CODES]
    special += ["<|translate|>", "<|transcribe|>", "<|startoflm|>", "<|startofprev|>"]
    special += ["<|nospeech|>", "<|notimestamps|>"]
    special += [f"<|{step * 0.02:.2f}|>" for step in range(1501)]
    tokenizer.add_special_tokens(special)
    tokenizer.save(str(folder / "tokenizer.json"))
    return dict(sorted(tokenizer.get_vocab().items(), key=lambda item: item[1]))


def _norm(layer) -> None:
    layer.gamma, layer.beta = np.ones(DEPTH, np.float32), np.zeros(DEPTH, np.float32)


def _linear(layer, rows: int) -> None:
    layer.weight = np.zeros((rows, DEPTH), np.float32)
    layer.bias = np.zeros(rows, np.float32)


def _feed_forward(layer) -> None:
    _norm(layer.layer_norm)
    layer.linear_0.weight = np.zeros((DEPTH, DEPTH), np.float32)
    layer.linear_0.bias = np.zeros(DEPTH, np.float32)
    layer.linear_1.weight = np.zeros((DEPTH, DEPTH), np.float32)
    layer.linear_1.bias = np.zeros(DEPTH, np.float32)


def _attention(layer, rows: tuple[int, ...]) -> None:
    _norm(layer.layer_norm)
    for linear, count in zip(layer.linear, rows, strict=True):
        _linear(linear, count)


def _encoder(encoder) -> None:
    encoder.conv1.weight = np.zeros((DEPTH, MELS, 3), np.float32)
    encoder.conv1.bias = np.zeros(DEPTH, np.float32)
    encoder.conv2.weight = np.zeros((DEPTH, DEPTH, 3), np.float32)
    encoder.conv2.bias = np.zeros(DEPTH, np.float32)
    encoder.position_encodings.encodings = np.zeros((1500, DEPTH), np.float32)
    _norm(encoder.layer_norm)
    _attention(encoder.layer[0].self_attention, (3 * DEPTH, DEPTH))
    _feed_forward(encoder.layer[0].ffn)


def _decoder(decoder, vectors, planted: list[int]) -> None:
    """The start token is given; the planted ones follow it."""
    decoder.embeddings.weight = vectors
    decoder.projection.weight = vectors
    decoder.scale_embeddings = False
    places = np.zeros((POSITIONS, DEPTH), np.float32)
    for place in range(POSITIONS):
        places[place] = SHARPNESS * vectors[planted[min(place, len(planted) - 1)]]
    decoder.position_encodings.encodings = places
    _norm(decoder.layer_norm)
    _attention(decoder.layer[0].self_attention, (3 * DEPTH, DEPTH))
    _attention(decoder.layer[0].attention, (DEPTH, 2 * DEPTH, DEPTH))
    _feed_forward(decoder.layer[0].ffn)
