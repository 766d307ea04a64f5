# SPDX-License-Identifier: GPL-3.0-or-later
#
# What the scripts of this folder share: the program and the number of parts of a plan.
ptin=${PTIN:-ptin}

# The number of parts that `ptin build --parts N --plan PLAN` wrote.
parts_of() {
  local parts
  if [ ! -r "$1" ]; then
    echo "${0##*/}: there is no plan $1; make it by: ptin build ... --parts N --plan $1" >&2
    return 2
  fi
  parts=$(sed -n 's/^ "parts": \([0-9]*\),\{0,1\}$/\1/p' "$1")
  if [ -z "$parts" ]; then
    echo "${0##*/}: $1 is no plan of ptin build --parts" >&2
    return 2
  fi
  echo "$parts"
}
