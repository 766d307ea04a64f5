# SPDX-License-Identifier: GPL-3.0-or-later
"""`ptin serve` as the benchmarks of the service start it, ask it and look at it; over loopback alone."""
import atexit
import http.client
import os
import re
import resource
import signal
import socket
import subprocess


class Service:
    def __init__(self, ptin, file, *options, threads=1, cores=None, descriptors=None):
        """Serves `file` as dem. The service stays on `cores`, and has so many `descriptors`, where they are given."""
        def begin():
            if cores:
                os.sched_setaffinity(0, cores)
            if descriptors:
                resource.setrlimit(resource.RLIMIT_NOFILE, (descriptors, descriptors))
        self.process = subprocess.Popen(
            [ptin, "serve", f"dem={file}", "--listen", "127.0.0.1:0", "--threads", str(threads), *options],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, preexec_fn=begin)
        atexit.register(self.process.kill)  # a benchmark that gives up leaves no service behind
        self.host, port = re.search(r"http://([0-9.]+):(\d+)", self.process.stdout.readline()).groups()
        self.port = int(port)
        self.address = f"{self.host}:{port}"

    def connect(self, client=0, receive=None):
        """A socket of client 0, 1 ..., each of which comes from an address of its own; with a small buffer where one is given."""
        made = socket.socket()
        if receive:
            made.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive)
        made.settimeout(60)
        made.bind((f"127.0.0.{client + 1}", 0))
        made.connect((self.host, self.port))
        return made

    def ask(self, target, body=None, client=0):
        """Status and body of an answer, by a connection of its own; a body is posted."""
        connection = http.client.HTTPConnection(self.host, self.port, 60, (f"127.0.0.{client + 1}", 0))
        headers = {"Connection": "close"} | ({"Content-Type": "application/json"} if body else {})
        try:
            connection.request("POST" if body else "GET", target, body, headers)
            answer = connection.getresponse()
            return answer.status, answer.read()
        finally:
            connection.close()

    def metric(self, name):
        return float(re.search(rf"^{name} (\S+)$", self.ask("/metrics")[1].decode(), re.M).group(1))

    def memory(self):
        """MiB, without the pages of the file."""
        with open(f"/proc/{self.process.pid}/status") as lines:
            kib = dict(re.findall(r"(RssAnon|RssShmem):\s+(\d+) kB", lines.read()))
        return sum(map(int, kib.values())) / 1024

    def end(self):
        """Its exit status."""
        self.process.send_signal(signal.SIGTERM)
        return self.process.wait(60)
