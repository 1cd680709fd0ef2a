#!/bin/sh
# Builds every fuzz target (preset "asan") and runs each for a while.
# usage: fuzz/run.sh [SECONDS_PER_TARGET] [FORMAT...]
# What is found is left in build/asan/findings; new corpus files in build/asan/corpus. Exit status 1 on a finding.
set -e
cd "$(dirname "$0")/.."
seconds=${1:-60}
[ $# -gt 0 ] && shift
formats=${*:-obj ply stl off t node mesh msh vtk vtu scene pc2}
cmake --preset asan
targets=
for format in $formats; do targets="$targets fuzz_read_$format"; done
# shellcheck disable=SC2086
cmake --build --preset asan --target $targets
mkdir -p build/asan/findings
# A fuzzer runs on one core: as many at a time as there are. Each writes a log, shown when all are done.
fuzz() {
  mkdir -p "build/asan/corpus/$1"
  # A reader may not ask for much more memory than its input holds: 256 MB at once is a finding.
  build/asan/fuzz/fuzz_read_"$1" -max_total_time="$seconds" -timeout=10 -max_len=20000 -malloc_limit_mb=256 \
    -rss_limit_mb=2048 -print_final_stats=1 -verbosity=0 -artifact_prefix="build/asan/findings/$1-" \
    "build/asan/corpus/$1" "fuzz/corpus/$1" >"build/asan/findings/$1.log" 2>&1 || touch "build/asan/findings/$1.failed"
}
rm -f build/asan/findings/*.failed
cores=$(nproc)
running=0
for format in $formats; do
  fuzz "$format" &
  running=$((running + 1))
  if [ "$running" -eq "$cores" ]; then
    wait
    running=0
  fi
done
wait
status=0
for format in $formats; do
  echo "== $format, $seconds s"
  cat "build/asan/findings/$format.log"
  if [ -e "build/asan/findings/$format.failed" ]; then status=1; fi
done
exit $status
