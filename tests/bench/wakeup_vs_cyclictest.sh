#!/bin/bash
# Wake-up lateness of a daemon's loop beside cyclictest's (package rt-tests): same period, priority
# and locked memory, in rounds that alternate. Prints the medians over the rounds and their ratios.
set -euo pipefail

if [[ $# -lt 1 || $# -gt 3 ]]; then
  echo "usage: $0 WAKEUP_PROGRAM [ROUNDS=10] [SECONDS=5]" >&2
  exit 2
fi
wakeup=$1 rounds=${2:-10} seconds=${3:-5}
command -v cyclictest > /dev/null || { echo "cyclictest is missing: apt install rt-tests" >&2; exit 2; }

# -> "p50 p99" [us]; a percentile beyond the histogram's 1 ms counts as 1 ms. --laptop leaves the
# processors their sleep states, as a daemon does.
cyclictest_round() {
  cyclictest --quiet --mlockall --laptop --priority=80 --interval=1000 --duration="$seconds" \
    --nsecs --histogram=1000000 2> /dev/null |
    awk '/^[0-9]/ { if ($2 > 0) { ns[++n] = $1; count[n] = $2; total += $2 } }
         /^# Histogram Overflows/ { total += $4 }
         END {
           p50 = p99 = 1000
           for (i = 1; i <= n; ++i) {
             seen += count[i]
             if (p50 == 1000 && seen >= 0.50 * total) p50 = ns[i] / 1000
             if (p99 == 1000 && seen >= 0.99 * total) p99 = ns[i] / 1000
           }
           print p50, p99
         }'
}

wakeup_round() {
  "$wakeup" "$seconds" | awk '{ print ($2 < 1000 ? $2 : 1000), ($4 < 1000 ? $4 : 1000) }'
}

# column -> its median
median() { sort -g | awk '{ v[NR] = $1 } END { print (v[int((NR + 1) / 2)] + v[int(NR / 2) + 1]) / 2 }'; }

ours=() theirs=()
for ((round = 1; round <= rounds; ++round)); do
  ours+=("$(wakeup_round)")
  theirs+=("$(cyclictest_round)")
  echo "round $round: loop p50 p99 = ${ours[-1]} us, cyclictest ${theirs[-1]} us"
done

for percentile in 1:p50 2:p99; do
  a=$(printf '%s\n' "${ours[@]}" | cut -d' ' -f"${percentile%:*}" | median)
  b=$(printf '%s\n' "${theirs[@]}" | cut -d' ' -f"${percentile%:*}" | median)
  awk -v name="${percentile#*:}" -v a="$a" -v b="$b" \
    'BEGIN { printf "%s: loop %.1f us, cyclictest %.1f us, ratio %.3f\n", name, a, b, a / b }'
done
