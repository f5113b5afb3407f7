#!/usr/bin/env bash
# Prints which share of the lines and branches of core, config and bridge/dds the unit tests execute, by clang's counters; MC/DC of the
# files below `decisions`; and the places of core without execution.
#
#   tools/coverage.sh [--all] [--folder DIR]
#
# --all: prints these places of config and bridge/dds too. Default folder: build-coverage. MC/DC: each condition has changed the result
# of its decision alone. A branch is a condition that was once true, or once false.
set -euo pipefail
cd "$(dirname "$0")/.."

folder=build-coverage listed='^core/'
while [ $# -gt 0 ]; do
  case "$1" in
    --folder) folder=$2; shift ;;
    --all) listed=. ;;
    *) sed -n '2,8s/^# \{0,1\}//p' "$0"; exit 2 ;;
  esac
  shift
done

tests=(core_test lzw_test program_test telnet_test plan_test dispatch_test schedule_test bus_test bus_run_test transcript_test
       simulation_test late_test freeport_noise_test shared_wire_test protocol_test declared_test config_test standby_test bridge_test
       whole_bridge_test cli_test group_day_test dds_conversion_test dds_link_test dds_settings_test dds_loss_test dds_security_test)
# The late-response filter, the arbiter of a bus, the election of a standby group, the guard against hostile datagrams.
decisions=(core/bus/wire/late_response_filter.cpp core/bus/exchange_flow.cpp bridge/standby/election.cpp bridge/dds/guard/{datagram_guard,parameter_list,rtps_message,rtps_validator}.cpp)

tools/install.sh coverage
tools/build.sh --folder "$folder" -DCMAKE_C_COMPILER=clang-19 -DCMAKE_CXX_COMPILER=clang++-19 -DFIELDCAST_COVERAGE=ON \
  -DFIELDCAST_BENCHES=OFF "${tests[@]}" >&2
counters=() objects=()
for test in "${tests[@]}"; do
  program=$folder/bin/$test
  counters+=("$program.profraw") objects+=(--object "$program")
done
# Runs a test again only after a change. One that fails has no counters.
export folder
printf '%s\n' "${tests[@]}" | xargs -P "$(nproc)" -I TEST bash -c '
  program=$folder/bin/TEST
  [ "$program.profraw" -nt "$program" ] && exit
  LLVM_PROFILE_FILE=$program.part "$program" --gtest_brief=1 >"$program.log" 2>&1 || { cat "$program.log" >&2; exit 1; }
  mv "$program.part" "$program.profraw"'
llvm-profdata-19 merge --sparse -o "$folder/tests.profdata" "${counters[@]}"
# Without a warning for each inline function that some source includes and does not call.
cov() { llvm-cov-19 "$@" 2> >(grep -v 'functions have mismatched data' >&2); }
cov export --format=lcov --instr-profile "$folder/tests.profdata" "${objects[@]:1}" "$PWD"/{core,config,bridge/dds} >"$folder/coverage.info"

# SF: path of a file. DA: line, executions. BRDA: line, two numbers of the branch, executions. Branches that the compiler makes for a
# defaulted comparison, and that of a failed assertion, do not count.
cat >"$folder/rows.awk" <<'AWK'
BEGIN { FS = "[:,]" }
$1 == "SF" {
  file = $2; sub(root, "", file); split(file, part, "/")
  top = part[1] == "bridge" ? "bridge/dds" : part[1]; inner = part[1] == "bridge" ? top "/" part[3] : part[1] "/" part[2]
  for (n = 0; (getline text[n] < $2) > 0; ++n);
  close($2)
}
function counts(line) { return text[line - 1] text[line] !~ /operator(==|<=>)\(.*= default;/ && text[line - 1] !~ /assert\(/ }
AWK
awk -v root="$PWD/" -f "$folder/rows.awk" -f - "$folder/coverage.info" <<'AWK' | sort
function add(what, all_of, hit) { all[what, top] += all_of; all[what, inner] += all_of; got[what, top] += hit; got[what, inner] += hit }
$1 == "SF" { names[top]; names[inner] }
$1 == "DA" { add("lines", 1, $3 > 0) }
# The sums count the instances of a template as one.
$1 == "BRF" { add("branches", $2, 0) }
$1 == "BRH" { add("branches", 0, $2) }
$1 == "BRDA" && !counts($2) { add("branches", -1, -($5 > 0)) }
function share(what, name) { return all[what, name] ? 100 * got[what, name] / all[what, name] : 100 }
END { for (name in names) printf "%-22s %6d lines %7.2f %% %6d branches %7.2f %%\n", name, all["lines", name], share("lines", name),
        all["branches", name], share("branches", name) }
AWK
echo
echo "MC/DC"
cov report --show-mcdc-summary --show-region-summary=false --instr-profile "$folder/tests.profdata" "${objects[@]:1}" \
  "${decisions[@]/#/$PWD/}"
echo
echo "lines that no test executes, and lines with a branch that no test takes (?)"
awk -v root="$PWD/" -f "$folder/rows.awk" -f - "$folder/coverage.info" <<'AWK' | grep "$listed" | sort -t : -k 1,1 -k 2n |
$1 == "DA" && $3 == 0 { what[file ":" $2] = "" }
$1 == "BRDA" && $5 == 0 && counts($2) && !(file ":" $2 in what) { what[file ":" $2] = "?" }
END { for (place in what) print place ":" what[place] }
AWK
  awk -F : '$1 != file { if (file) print line; file = line = $1 } { line = line " " $2 $3 } END { if (file) print line }'
