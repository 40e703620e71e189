#!/usr/bin/env bash
# Searches for inputs that break the readers of files: libFuzzer, under the address and undefined-behaviour sanitizers.
#
#   scripts/fuzz.sh [SECONDS] [NAME...]
#
# SECONDS a reader, 60 unless given; NAMEs are those of tests/fuzz/corpus, all unless given. What is found on the way is
# kept in build-fuzz/corpus and is where the next run begins. An input that breaks a reader ends it, and its path is
# printed. Without clang nothing is done.
set -euo pipefail
usage() { sed -n '2,/^$/s/^# \{0,1\}//p; /^set /q' "$0"; }
case "${1:-60}" in
-h | --help) usage; exit 0 ;;
*[!0-9]* | '') usage >&2; exit 2 ;;
esac
cd "$(dirname "$0")/.."

seconds=${1:-60}
shift || true
[ $# -gt 0 ] || set -- xml ply obj serialized exr png jpg hdr tga
if ! command -v clang++ > /dev/null || ! clang++ -fsanitize=fuzzer -x c++ - -o /dev/null 2> /dev/null <<< \
    'extern "C" int LLVMFuzzerTestOneInput(const unsigned char *, unsigned long) { return 0; }'; then
    echo "fuzz: skipped: no clang++ with libFuzzer (Debian: clang)"
    exit 0
fi
cmake --preset fuzz > /dev/null
cmake --build --preset fuzz --parallel "$(nproc)"
export LSAN_OPTIONS=suppressions=$PWD/tests/fuzz/leaks.txt:print_suppressions=0
failed=0
for name in "$@"; do
    found=build-fuzz/corpus/$name
    mkdir -p "$found"
    # Leaks are looked for at the end: after each run that failed it takes far longer than the run. And
    # without entropic scheduling, which takes a quarter of the time.
    options=(-detect_leaks=0 -entropic=0 -max_total_time="$seconds" -timeout=120 -rss_limit_mb=4096 -max_len=16384
        -print_final_stats=1 -verbosity=0 -artifact_prefix="build-fuzz/$name-")
    if [ "$name" = xml ]; then # its words, and the names of all plugins and parameters
        { cat tests/fuzz/xml.dict && grep -o '`[a-z][a-z_0-9]*`' docs/scene-format.md | sort -u | tr '`' '"'; } > build-fuzz/xml.dict
        options+=(-dict=build-fuzz/xml.dict)
    fi
    if build-fuzz/tests/fuzz/fuzz_"$name" "${options[@]}" "$found" "tests/fuzz/corpus/$name" &> "build-fuzz/$name.log"; then
        echo "$name: $(sed -n 's/^stat::number_of_executed_units: *//p' "build-fuzz/$name.log") runs, nothing found"
    else
        tail -n 40 "build-fuzz/$name.log"
        # libFuzzer tells where it puts an input; inputs that are merely slow are written too.
        broken=$(sed -n '/slow-unit-/d; s/^.*Test unit written to //p' "build-fuzz/$name.log" | tail -n 1)
        echo "$name: broken by ${broken:-no input of its own, see build-fuzz/$name.log}"
        failed=1
    fi
done
exit $failed
