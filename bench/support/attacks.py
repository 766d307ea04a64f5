# SPDX-License-Identifier: GPL-3.0-or-later
"""Slow, greedy and broken clients of `ptin serve`, over loopback alone: functions of a service, so many seconds and so many
connections. slowhttptest is Debian's package."""
import socket
import subprocess
import threading
import time


def slow_http(*options):
    def attack(service, seconds, connections):
        subprocess.run(["slowhttptest", *options, "-c", str(connections), "-r", "400", "-l", str(seconds), "-i", "1", "-p", "3",
                        "-u", f"http://{service.address}/collections/dem/file"],
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=seconds + 60)
    return attack


def hold(clients, seconds, each=lambda client: None, pause=0.5):
    until = time.time() + seconds
    while time.time() < until:
        for client in clients:
            try:
                each(client)
            except OSError:
                pass
        time.sleep(pause)
    for client in clients:
        client.close()


def slow_readers(service, seconds, connections):
    """They take the file a byte at a time."""
    clients = []
    for _ in range(connections):
        clients.append(service.connect(receive=4096))
        clients[-1].sendall(b"GET /collections/dem/file HTTP/1.1\r\nHost: a\r\n\r\n")
        clients[-1].setblocking(False)
    hold(clients, seconds, lambda c: c.recv(1), 1.0)


def greedy_readers(service, seconds, connections):
    """They have the room that the system gives, and read nothing."""
    clients = []
    for _ in range(connections):
        clients.append(service.connect())
        clients[-1].sendall(b"GET /collections/dem/file HTTP/1.1\r\nHost: a\r\n\r\n")
    hold(clients, seconds)


def huge_headers(service, seconds, connections):
    """200 MB of one header, by four at once, until they are cut off."""
    def one():
        client = service.connect()
        try:
            client.sendall(b"GET / HTTP/1.1\r\nHost: a\r\nX: ")
            for _ in range(3200):
                client.sendall(b"a" * 65536)
        except OSError:
            pass
        client.close()
    until = time.time() + min(seconds, 10)
    while time.time() < until:
        threads = [threading.Thread(target=one) for _ in range(4)]
        for t in threads:
            t.start()
        for t in threads:
            t.join()


def ranges(service, seconds, connections):
    """A thousand ranges over each other in one request, and single ones of the whole file, left at once."""
    many = "bytes=" + ",".join("0-" for _ in range(1000))
    until = time.time() + min(seconds, 10)
    while time.time() < until:
        for header in [many, "bytes=0-", "bytes=-1"]:
            client = service.connect()
            client.sendall(f"GET /collections/dem/file HTTP/1.1\r\nHost: a\r\nRange: {header}\r\n\r\n".encode())
            client.recv(100)
            client.close()


def drips(service, seconds, connections):
    """64 requests whose head comes a byte a second."""
    clients = [service.connect() for _ in range(64)]
    head = b"GET /collections/dem/highest?crs=native HTTP/1.1\r\nHost: a\r\n\r\n"
    sent = {}

    def drip(client):
        at = sent.get(client, 0)
        client.send(head[at:at + 1])
        sent[client] = at + 1
    hold(clients, seconds, drip, 1.0)


def half_closed(service, seconds, connections):
    """Clients that close their sending side within the head, the body, and after the request."""
    clients = []
    for i in range(connections):
        client = service.connect()
        client.sendall([b"GET / HT", b"POST /collections/dem/position HTTP/1.1\r\nHost: a\r\nContent-Length: 9\r\n\r\n{",
                        b"GET /collections/dem/file HTTP/1.1\r\nHost: a\r\n\r\n"][i % 3])
        client.shutdown(socket.SHUT_WR)
        clients.append(client)
    hold(clients, seconds)


ATTACKS = {
    "slowhttptest -H": slow_http("-H"),
    "slowhttptest -B": slow_http("-B"),
    "slowhttptest -X": slow_http("-X", "-w", "512", "-y", "1024", "-n", "5", "-z", "32", "-k", "1"),
    "slow readers of /file": slow_readers,
    "readers of /file that do not read": greedy_readers,
    "headers of 200 MB": huge_headers,
    "ranges over each other": ranges,
    "64 slow drips": drips,
    "half-closed sockets": half_closed,
}
