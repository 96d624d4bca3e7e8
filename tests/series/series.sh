# What the tests of series share; sourced by them.

# run_series SOURCE BUILD OUT MAKE-WORDS...: the sample photos from start to end. Status 4 (flagged rows) is done, too;
# anything else ends the test.
run_series() {
    local source=$1 build=$2 out=$3 status=0
    shift 3
    make -f "$source/pipeline/Makefile" SCENE="$source/sample_images/scene.json" BUILD="$build" OUT="$out" \
        METHOD=cem,qsm,cdm,map START=overlap "$@" >"$out.log" 2>&1 || status=$?
    if ((status)) && ! grep -q '^done; .*: status 4$' "$out.log"; then
        cat "$out.log"
        exit 1
    fi
}

# same_results A B: every result of one folder is in the other, byte for byte.
same_results() {
    local a=$1 b=$2
    diff <(cd "$a" && ls) <(cd "$b" && ls) || { echo "not the same files in $a and $b"; return 1; }
    (cd "$a" && sha256sum [0-9]*.* report.html) | (cd "$b" && sha256sum --check --quiet)
}
