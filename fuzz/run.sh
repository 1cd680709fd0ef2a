#!/bin/sh
# Builds every fuzz target (preset "asan") and runs each for a while.
# usage: fuzz/run.sh [SECONDS_PER_TARGET] [FORMAT...]
# What is found is left in build/asan/findings; new corpus files in build/asan/corpus. Exit status 1 on a finding.
set -e
cd "$(dirname "$0")/.."
seconds=${1:-60}
[ $# -gt 0 ] && shift
formats=${*:-obj ply stl off t node mesh msh vtk vtu scene}
cmake --preset asan
targets=
for format in $formats; do targets="$targets fuzz_read_$format"; done
# shellcheck disable=SC2086
cmake --build --preset asan --target $targets
mkdir -p build/asan/findings
status=0
for format in $formats; do
  mkdir -p "build/asan/corpus/$format"
  echo "== $format, $seconds s"
  # A reader may not ask for much more memory than its input holds: 256 MB at once is a finding.
  build/asan/fuzz/fuzz_read_"$format" -max_total_time="$seconds" -timeout=10 -max_len=20000 -malloc_limit_mb=256 \
    -rss_limit_mb=2048 -print_final_stats=1 -verbosity=0 -artifact_prefix="build/asan/findings/$format-" \
    "build/asan/corpus/$format" "fuzz/corpus/$format" || status=1
done
exit $status
