#!/usr/bin/env bash
# scripts/fuzz.sh: runs each fuzzer ten minutes. New inputs are kept in build-fuzz/found/NAME, what broke a claim in
# build-fuzz/findings/NAME; `build-fuzz/tests/fuzz/fuzz_NAME FILE` runs one again and prints its values. The status is 1
# when there is a finding, or a fuzzer did not run.
#   --minutes N    instead of ten
#   --only NAME    one fuzzer: calls, state, run_sphere, run_cylinder, run_three_balls, run_two_pairs, scene_files
#   -h, --help     prints this
source "$(dirname "${BASH_SOURCE[0]}")/prologue.sh"
help_asked "$@"
cd "$root"

minutes=10
names=(calls state run_sphere run_cylinder run_three_balls run_two_pairs scene_files)
while (($# > 0)); do
    case $1 in
        --minutes) [[ ${2:-} =~ ^[1-9][0-9]*$ ]] || refuse "--minutes takes a whole number"; minutes=$2; shift 2 ;;
        --only) [[ " ${names[*]} " == *" ${2:-} "* ]] || refuse "--only takes one of: ${names[*]}"; names=("$2"); shift 2 ;;
        *) refuse "unknown argument $1" ;;
    esac
done

set_up
cmake --preset fuzz -Wno-dev --log-level=WARNING -DPython3_EXECUTABLE="$python"
targets=()
for name in "${names[@]}"; do
    [[ $name == scene_files ]] || targets+=("fuzz_$name")
done
((${#targets[@]} == 0)) || cmake --build --preset fuzz --target "${targets[@]}" -- --quiet

findings=0
for name in "${names[@]}"; do
    printf '\n== %s, %d minutes\n' "$name" "$minutes"
    if [[ $name == scene_files ]]; then
        CONTACT_FUZZ_MINUTES=$minutes "$python" -m pytest -q -p no:cacheprovider tests/fuzz/test_scene_files.py \
            </dev/null || findings=1
        continue
    fi
    corpus=$root/tests/fuzz/corpus/fuzz_${name%%_*}
    found=$root/build-fuzz/found/$name
    broken=$root/build-fuzz/findings/$name
    mkdir -p "$found" "$broken"
    # A fuzzer goes on after a finding; inputs are tried in other lengths from the start. The most work an input can ask for,
    # 2 runs of 12 communication steps of 2000 internal steps, takes six seconds of a processor; on a busy machine that may last
    # twenty times as long.
    (cd "$broken" && nice "$root/build-fuzz/tests/fuzz/fuzz_$name" -fork=1 -ignore_crashes=1 -ignore_timeouts=1 \
        -ignore_ooms=1 -timeout=120 -report_slow_units=120 -rss_limit_mb=2000 -max_len=500 -len_control=0 \
        -max_total_time=$((60 * minutes)) "$found" "$corpus" >log 2>&1 </dev/null) || true
    tail -n 1 "$broken/log"
    count=$(find "$broken" -type f ! -name log | wc -l)
    printf '%s: %d findings in %s\n' "$name" "$count" "${broken#"$root"/}"
    ((count == 0)) || findings=1
    # libFuzzer's last words; without them it did not run, and nothing was looked for.
    if ! grep -q '^INFO: exiting' "$broken/log"; then
        printf '%s: did not run to its end, see %s/log\n' "$name" "${broken#"$root"/}" >&2
        findings=1
    fi
done
exit "$findings"
