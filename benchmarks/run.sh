#!/bin/sh
# run.sh BUILD: every benchmark of BUILD; what they print and their JSON, with the machine's name, go to BUILD/results.
set -eu
build=$1
results=$build/results
mkdir -p "$results"
{
  date -u +%Y-%m-%d
  sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1
  nproc
} >"$results/machine.txt"
for name in boundary-path self-collision simulation; do
  "$build/selvage_bench" $name --json "$results/$name.json" | tee "$results/$name.txt"
done
"$build/benchmarks/selvage_microbench" --benchmark_out="$results/micro.json" | tee "$results/micro.txt"
