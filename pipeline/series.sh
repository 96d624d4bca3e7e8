# What the drivers of a series share (pipeline/Makefile, pipeline/slurm/run); sourced by them, with SCENE, OUT, BUILD,
# METHOD, START and ALLOW_OUTSIDE as the user gave them, empty where not. Sets OUT and BUILD where they are empty.

refuse() {
    printf '%s\n' "${*//[[:cntrl:]]/?}" >&2
    exit 2
}

pipeline=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
[[ $SCENE ]] || refuse "which experiment? Give SCENE=path/scene.json"
OUT=${OUT:-$(dirname -- "$SCENE")/results} BUILD=${BUILD:-build}
for name in SCENE OUT BUILD; do
    [[ ${!name} != -* ]] || declare "$name=./${!name}" # no option of a program
done
[[ -x $BUILD/bin/scene ]] || refuse "there are no programs in $BUILD/bin: build them with" \
    "\`cmake -S . -B $BUILD && cmake --build $BUILD\`, or give BUILD=folder"

# planner COMMAND OPTIONS...
planner() {
    "$BUILD/bin/scene" "$@" --output "$OUT" --method "$METHOD" --start "$START" ${ALLOW_OUTSIDE:+--allow-outside} "$SCENE"
}

# check_words: what forces does not know would fail only after every photo was followed.
check_words() {
    "$BUILD/bin/forces" ${METHOD:+--method "$METHOD"} ${START:+--start "$START"} --help >/dev/null || exit 2
}

# alone: from here to the end of this process nobody else works in OUT. The stages inherit the lock, so that a killed
# driver whose last stage still writes keeps others away.
alone() {
    local path
    for path in "$OUT"/{.lock,.scene,.running,.flagged,.failed,.sums,logs}; do # a folder from somebody else
        [[ ! -L $path ]] || refuse "$path: is a symbolic link: remove it, nothing is written through links"
    done
    mkdir -p "$OUT"/{.scene,.running,.flagged,.failed,.sums,logs}
    exec 8>>"$OUT/.lock"
    flock --nonblock 8 || refuse "another run works in $OUT: wait for it"
}

# scratch [--directory]: a new file or folder where TMPDIR says, or in /tmp where that is not there.
scratch() {
    mktemp "$@" 2>/dev/null || TMPDIR=/tmp mktemp "$@"
}

# begin N K: the makefile $plan, to be run in $folder; N not empty: nothing is changed anywhere; K not empty: what the
# scene names and is not there stops only what needs it.
begin() {
    check_words
    if [[ $1 ]]; then
        scratch=$(scratch --directory)
        trap 'rm -rf "$scratch"' EXIT
        folder=$scratch plan=$scratch/plan.mk
        [[ ! -d $OUT ]] || folder=$OUT
    else
        alone
        folder=$OUT plan=$OUT/.scene/plan.mk
        rm -f "$plan" "$OUT"/.*.tmp # with the lock in hand: of the dead
        planner begin
    fi
    planner plan --format make --runner "$pipeline/stage" >"$plan"
    plan=$(realpath -- "$plan")
    planner check || [[ $1$2 || $? == 4 ]] || exit 2
}

# threads_beside JOBS: for each of so many programs at a time, so that all together have the processors once.
threads_beside() {
    local each=$(($(nproc) / $1))
    echo $((each > 0 ? each : 1))
}

# last_word STATUS: of make or Snakemake; the last line, and the status of the run: 4 where a stage flagged more rows
# than allowed.
last_word() {
    local results failed flagged
    results=$(planner results)
    failed=$(sed -n 's/\tfailed\t.*//p' <<<"$results" | paste -sd ' ')
    flagged=$(sed -n 's/\tflagged\t.*//p' <<<"$results" | paste -sd ' ')
    (($1 == 0)) || { echo "${failed:+not done: ${failed// /, }: }status $1"; exit "$1"; }
    if [[ $flagged ]]; then # why, in the words of the stages: one line each, the first ten
        find "$OUT/.flagged" -type f -size +0 -print0 | sort -z | xargs -0 -r sed -s -n '$p' | head -n 10
        echo "done, but not all is as it should be in $flagged: status 4"
        exit 4
    fi
    echo "done: $OUT/report.html"
}

show_status() {
    [[ -d $OUT ]] || { echo "nothing is done yet"; return; }
    planner status
}

# verify: every result is there, and report verify is content with them.
verify() {
    [[ -d $OUT ]] || { echo "nothing is done yet"; exit 1; }
    local results missing there bin scene
    results=$(planner results) list=$(scratch)
    trap 'rm -f "$list"' EXIT
    missing=$(sed -n 's/\t.*\tabsent$//p' <<<"$results" | paste -sd ' ')
    [[ ! $missing ]] || echo "missing: $missing"
    # The picture of the grains is made with them.
    there=$(sed -n 's/\t.*\tthere$//p' <<<"$results" | sed 's/\(.*\.grains\)\.hdf$/&\n\1.png/')
    bin=$(realpath -- "$BUILD/bin") scene=$(realpath -s -- "$SCENE")
    printf '%s' "${there:+$there$'\n'}" >"$list"
    [[ ! $there ]] ||
        (cd -- "$OUT" && "$bin/report" verify ${ALLOW_OUTSIDE:+--allow-outside} --scene "$scene" --list "$list")
    [[ ! $missing ]]
}
