# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of Markdown, printed row by row."""


def print_row(*cells):
    print("| " + " | ".join(map(str, cells)) + " |", flush=True)


def print_head(*cells):
    print_row(*cells)
    print_row(*["---"] * len(cells))


def print_table(head, rows):
    print_head(*head)
    for row in rows:
        print_row(*row)
