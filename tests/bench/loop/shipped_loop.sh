#!/bin/bash
# Starts the integrator and the controller of a rig as they are shipped, in a network namespace of
# their own, balances it and measures with loop_latency. JSON lines on stdout.
set -euo pipefail
if [[ $# -lt 1 || $# -gt 3 ]]; then
  echo "usage: $0 FOLDER_OF_PROGRAMS [SECONDS=10] [RIG=prototype_b]" >&2
  exit 2
fi
bin=$(realpath "$1") seconds=${2:-10} rig=${3:-prototype_b}
here=$(realpath "$(dirname "$0")")
if [[ -z ${GYROTWIN_SHIPPED_LOOP:-} ]]; then
  export GYROTWIN_SHIPPED_LOOP=1
  exec "$here/../../support/in_namespace" "$here/$(basename "$0")" "$bin" "$seconds" "$rig"
fi

GYROTWIN_KEYS=$(mktemp -d)
export GYROTWIN_KEYS
started=()
finish() {
  kill "${started[@]}" 2> /dev/null || true
  wait
  rm -r "$GYROTWIN_KEYS"
}
trap finish EXIT
{
  "$bin/gyrotwin" key new --rig "$rig"
  "$bin/gyrotwin-integrator" --rig "$rig" &
  started+=($!)
  "$bin/gyrotwin-controller" --rig "$rig" &
  started+=($!)
  "$bin/gyrotwin" ctl --rig "$rig" wait ready --timeout 60
  "$bin/gyrotwin" ctl --rig "$rig" arm
} >&2
"$bin/loop_latency" "$rig" "$seconds"
