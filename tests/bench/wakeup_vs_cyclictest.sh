#!/bin/bash
# Wake-up lateness of a daemon's loop beside cyclictest's (package rt-tests): same period, priority
# and locked memory, one after the other. JSON lines, one value each; run it in rounds.
set -euo pipefail

if [[ $# -lt 1 || $# -gt 2 ]]; then
  echo "usage: $0 WAKEUP_PROGRAM [SECONDS=5]" >&2
  exit 2
fi
wakeup=$1 seconds=${2:-5}
command -v cyclictest > /dev/null || { echo "cyclictest is missing: apt-get install rt-tests" >&2; exit 2; }

# Two subjects share wakeup's time. --laptop leaves the processors their sleep states, as a daemon does.
"$wakeup" "$((2 * seconds))"
cyclictest --quiet --mlockall --laptop --priority=80 --interval=1000 --duration="$seconds" \
  --nsecs --histogram=1000000 2> /dev/null |
  awk 'function say(quantity, us) {
         printf "{\"figure\": \"wakeup\", \"case\": \"1000\", \"subject\": \"cyclictest\", "
         printf "\"quantity\": \"%s\", \"unit\": \"us\", \"value\": %g}\n", quantity, us
       }
       /^[0-9]/ { if ($2 > 0) { ns[++n] = $1; count[n] = $2; total += $2 } }
       /^# Histogram Overflows/ { total += $4 }
       /^# Max Latencies/ { max = $4 / 1000 }
       END {
         p50 = p99 = 1000  # beyond the histogram
         for (i = 1; i <= n; ++i) {
           seen += count[i]
           if (p50 == 1000 && seen >= 0.50 * total) p50 = ns[i] / 1000
           if (p99 == 1000 && seen >= 0.99 * total) p99 = ns[i] / 1000
         }
         say("p50", p50); say("p99", p99); say("max", max)
       }'
