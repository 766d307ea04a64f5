#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A web server of a folder that counts, delays and misbehaves, for tests and benchmarks.

usage: range_server.py FOLDER [--delay SECONDS]

Prints its port and a newline when it is ready, and ends with its standard input. Each request waits for the delay
first. What comes first in the path says how the server behaves; the rest names the file:

  /plain/F              ranges, ETag, Last-Modified
  /bare/F               ranges, and nothing by which to know the object
  /whole/F              no ranges: status 200 and all of the file
  /missing/F            404; /refused/F: 403
  /busy-N/F             of the requests for F, N (a number) are answered by 503, then one by one as /plain
  /limit-N/F            the same by 429, with Retry-After: 0
  /down/F               always 503
  /cut-N/F              the first N answers end in the middle
  /always-cut/F         each answer does
  /reset-N/F            the first N connections are reset without an answer
  /replaced-N/F         from request N on (from 0) another object: the file F.other, with its own ETag
  /swapped-N/F          the same, with neither ETag nor Last-Modified: only its bytes tell
  /weak-N/F             the same, with Last-Modified alone
  /deaf-N/F             as /replaced-N, by a server that does not know If-Match
  /wrong/F              after the first request, other bytes than were asked for, and it says so
  /shifted/F            after the first request, other bytes than were asked for, and it does not say so
  /packed/F             Content-Encoding: gzip
  /silent/F             after the first request, nothing is ever sent
  /gate-N/F             after the first request, answers wait until N requests are under way at once; for a minute at most
  /moved/F              a redirection to /plain/F
  /bucket/F             as a store of objects: a signature of AWS4-HMAC-SHA256 in the query, by KEY and SECRET below

GET /counts: JSON of all since the last GET /reset: requests, bytes, the most at once, and the ranges asked for.
"""
import argparse
import datetime
import email.utils
import hashlib
import hmac
import http.server
import json
import os
import re
import socket
import struct
import sys
import threading
import time
import urllib.parse

KEY, SECRET, REGION = "PTINTESTKEY", "ptin/test+secret", "us-east-1"


class Counts:
    def __init__(self):
        self.lock = threading.Condition()
        self.now = 0  # not reset: a request whose answer has arrived may not have ended here
        self.reset()

    def reset(self):
        self.requests = self.bytes = self.most = 0
        self.ranges = []
        self.seen = {}  # requests by path


def signature_fault(method, path, query, headers):
    """Why a request is not signed by SECRET; None when it is. As AWS describes it, "Authenticating Requests:
    Using Query Parameters (AWS Signature Version 4)"."""
    fields = dict(urllib.parse.parse_qsl(query, keep_blank_values=True))
    if fields.get("X-Amz-Algorithm") != "AWS4-HMAC-SHA256":
        return "no signature"
    scope = fields["X-Amz-Credential"].split("/", 1)
    date = fields["X-Amz-Date"]
    if scope[0] != KEY or scope[1] != f"{date[:8]}/{REGION}/s3/aws4_request":
        return "another key or scope"
    then = datetime.datetime.strptime(date, "%Y%m%dT%H%M%SZ").replace(tzinfo=datetime.timezone.utc)
    if time.time() > then.timestamp() + int(fields["X-Amz-Expires"]):
        return "too old"
    signed = fields["X-Amz-SignedHeaders"].split(";")
    pairs = sorted((k, v) for k, v in fields.items() if k != "X-Amz-Signature")
    canonical = "\n".join(
        [method, path, "&".join(f"{quoted(k)}={quoted(v)}" for k, v in pairs)]
        + [f"{name}:{headers[name].strip()}" for name in signed]
        + ["", ";".join(signed), "UNSIGNED-PAYLOAD"]
    )
    text = "\n".join(["AWS4-HMAC-SHA256", date, scope[1], hashlib.sha256(canonical.encode()).hexdigest()])
    key = ("AWS4" + SECRET).encode()
    for part in (date[:8], REGION, "s3", "aws4_request"):
        key = hmac.new(key, part.encode(), hashlib.sha256).digest()
    wanted = hmac.new(key, text.encode(), hashlib.sha256).hexdigest()
    return None if hmac.compare_digest(wanted, fields["X-Amz-Signature"]) else "another signature"


def quoted(text):
    return urllib.parse.quote(text, safe="-_.~")


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    counts = Counts()
    folder, delay = ".", 0.0

    def log_message(self, *arguments):
        pass

    def do_HEAD(self):
        self.do_GET()

    def do_GET(self):
        path, _, query = self.path.partition("?")
        if path in ("/counts", "/reset"):
            self.tell(path)
            return
        counts = self.counts
        with counts.lock:
            number = counts.seen.get(path, 0)
            counts.seen[path] = number + 1
            counts.requests += 1
            counts.now += 1
            counts.most = max(counts.most, counts.now)
            counts.ranges.append(self.headers.get("Range", ""))
            counts.lock.notify_all()
        try:
            time.sleep(self.delay)
            self.answer(path, query, number)
        except (BrokenPipeError, ConnectionResetError):
            self.close_connection = True
        finally:
            with counts.lock:
                counts.now -= 1

    def tell(self, path):
        with self.counts.lock:
            c = self.counts
            text = json.dumps({"requests": c.requests, "bytes": c.bytes, "most": c.most, "ranges": c.ranges}).encode()
            if path == "/reset":
                c.reset()
        self.send_response(200)
        self.send_header("Content-Length", str(len(text)))
        self.end_headers()
        self.wfile.write(text)

    def refuse(self, status, headers=()):
        self.send_response(status)
        for name, value in headers:
            self.send_header(name, value)
        self.send_header("Content-Length", "0")
        self.end_headers()

    def answer(self, path, query, number):
        parts = path.split("/", 2)
        mode, _, least = parts[1].partition("-") if re.search(r"-\d+$", parts[1]) else (parts[1], "", "0")
        least = int(least)
        name = os.path.join(self.folder, urllib.parse.unquote(parts[2]) if len(parts) > 2 else "")
        if mode == "moved":
            self.refuse(302, [("Location", "/plain/" + parts[2])])
            return
        if mode == "bucket":
            fault = signature_fault(self.command, path, query, self.headers)
            if fault is not None:
                sys.stderr.write(f"range_server: {path}: {fault}\n")
                self.refuse(403)
                return
        if mode == "refused":
            self.refuse(403)
        elif mode == "missing" or not os.path.isfile(name):
            self.refuse(404)
        elif mode == "down" or (mode == "busy" and number < least):
            self.refuse(503)
        elif mode == "limit" and number < least:
            self.refuse(429, [("Retry-After", "0")])
        elif mode == "reset" and number < least:
            self.connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            self.connection.close()
            self.close_connection = True
        elif mode == "silent" and number > 0:
            time.sleep(600)
        else:
            if mode == "gate" and number > 0:
                with self.counts.lock:
                    self.counts.lock.wait_for(lambda: self.counts.most >= least, timeout=60)
            if mode in ("replaced", "swapped", "weak", "deaf") and number >= least:
                name += ".other"
            self.send_range(mode, name, number, least)

    def identity(self, mode, name):
        """Headers by which the object is known, and its ETag."""
        facts = os.stat(name)
        etag = f'"{facts.st_size:x}-{facts.st_mtime_ns:x}-{hashlib.md5(name.encode()).hexdigest()[:8]}"'
        # The other object is an hour younger, whatever the clock says.
        modified = email.utils.formatdate(1_700_000_000 + (3600 if name.endswith(".other") else 0), usegmt=True)
        if mode in ("bare", "swapped"):
            return [], ""
        if mode == "weak":
            return [("Last-Modified", modified)], ""
        return [("ETag", etag), ("Last-Modified", modified)], etag

    def send_range(self, mode, name, number, least):
        headers, etag = self.identity(mode, name)
        total = os.path.getsize(name)
        match = re.fullmatch(r"bytes=(\d+)-(\d+)", self.headers.get("Range", ""))
        if mode != "deaf" and self.headers.get("If-Match") not in (None, "*", etag):
            self.refuse(412)
            return
        if mode == "packed":
            headers.append(("Content-Encoding", "gzip"))
        if match is None or mode == "whole":
            first, last = 0, total - 1
            self.send_response(200)
        else:
            first, last = int(match[1]), min(int(match[2]), total - 1)
            if first >= total:
                self.refuse(416, [("Content-Range", f"bytes */{total}")])
                return
            said = first
            if mode in ("wrong", "shifted") and number > 0:
                first, last = first - 4096, last - 4096
                said = first if mode == "wrong" else first + 4096
            self.send_response(206)
            self.send_header("Content-Range", f"bytes {said}-{said + last - first}/{total}")
        for header in headers:
            self.send_header(*header)
        self.send_header("Content-Length", str(last + 1 - first))
        self.end_headers()
        if self.command == "HEAD":
            return
        with open(name, "rb") as file:
            file.seek(first)
            body = file.read(last + 1 - first)
        is_cut = mode == "always-cut" or (mode == "cut" and number < least)
        if is_cut:
            body = body[: len(body) // 2]
            self.close_connection = True
        with self.counts.lock:
            self.counts.bytes += len(body)
        self.wfile.write(body)


class Server(http.server.ThreadingHTTPServer):
    daemon_threads = True
    request_queue_size = 128

    def handle_error(self, request, client_address):
        pass  # a client that leaves


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder")
    parser.add_argument("--delay", type=float, default=0.0)
    arguments = parser.parse_args()
    Handler.folder, Handler.delay = arguments.folder, arguments.delay
    server = Server(("127.0.0.1", 0), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    print(server.server_address[1], flush=True)
    sys.stdin.read()


if __name__ == "__main__":
    main()
