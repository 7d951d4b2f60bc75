"""A voice server: speaks the schema of docs/voices.md, here with the voice of hibari.

    python examples/http_voice_server.py --port 8123 &
    lipwright say "Hello there." --voice http://127.0.0.1:8123/speak -o hello.mp4

To wrap a cloud voice, let `speak` ask the cloud and return its sound and its times; the rest
stays. It answers this machine only; to others put a server in front that knows who may ask.
"""

from __future__ import annotations

import argparse
import base64
import io
import json
import os
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Lock
from typing import Any

import soundfile

from lipwright.errors import LipwrightError
from lipwright.speech.voices import Piece, Voice, find_voice

MOST_BYTES = 1 << 20  # of a request
TOKEN = os.environ.get("LIPWRIGHT_VOICE_TOKEN", "")


def speak(voice: Voice, request: dict[str, Any]) -> dict[str, Any]:
    """The answer to a request: sound, phones and words with times in s."""
    script = tuple(
        Piece(piece["text"], tuple(piece["phones"]), piece["pause"], piece["emphasis"],
              piece["rate"])
        for piece in request["pieces"]
    )  # fmt: skip
    said = voice.speak(script, "the request")
    assert said.track is not None  # hibari tells times
    file = io.BytesIO()
    soundfile.write(file, said.audio.samples, said.audio.rate, "PCM_16", format="FLAC")
    spans = [(word.text, *said.track.word_span(word)) for word in said.track.words]
    return {
        "version": 1,
        "audio": base64.b64encode(file.getvalue()).decode("ascii"),
        "alphabet": "arpabet",
        "phones": [{"phone": phone, "start": start, "end": end}
                   for phone, start, end in said.track],
        "words": [{"text": text, "start": start, "end": end} for text, start, end in spans],
    }  # fmt: skip


class Handler(BaseHTTPRequestHandler):
    """POST to any address."""

    voice: Voice
    lock = Lock()

    def do_POST(self) -> None:
        """Answer one request."""
        if TOKEN and self.headers.get("Authorization") != f"Bearer {TOKEN}":
            return self.answer(401, {"error": "wrong or no token"})
        length = self.headers.get("Content-Length", "")
        if not length.isdecimal() or int(length) > MOST_BYTES:
            return self.answer(413, {"error": f"give a text of at most {MOST_BYTES} bytes"})
        try:
            request = json.loads(self.rfile.read(int(length)))
            with self.lock:  # one text at a time
                body = speak(self.voice, request)
        except LipwrightError as error:
            return self.answer(422, {"error": str(error)})
        except (ValueError, KeyError, TypeError) as error:
            return self.answer(400, {"error": f"not a request of the schema: {error}"})
        return self.answer(200, body)

    def answer(self, status: int, body: dict[str, Any]) -> None:
        """Send JSON."""
        content = json.dumps(body).encode()
        self.send_response(status)
        self.send_header("Content-Type", "application/json; charset=utf-8")
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)


def main() -> None:
    """Serve until Ctrl-C."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--port", type=int, default=8123)
    parser.add_argument("--voice", default="hibari")
    options = parser.parse_args()
    Handler.voice = find_voice(options.voice)
    with ThreadingHTTPServer(("127.0.0.1", options.port), Handler) as server:
        print(f"http://127.0.0.1:{server.server_address[1]}/speak", flush=True)
        server.serve_forever()


if __name__ == "__main__":
    main()
