# What the tests of faults share; sourced by them. They run every program on a tiny series (13 rods, 3 photos of
# 260 x 300) and compare with what an undisturbed run makes.

# The scripts work in a folder of their own: where SOURCE and BUILD are must not depend on it.
set -- "$(realpath "$1")" "$(realpath "$2")" "${@:3}"

complaints=0
complain() {
    echo "WRONG: $*"
    complaints=$((complaints + 1))
}

# tiny_series SOURCE BIN FOLDER: scene, photos, loads, and one file of each stage, all that the commands below read.
tiny_series() {
    local source=$1 bin=$2 folder=$3 n
    mkdir -p "$folder/photos" "$folder/out"
    cp "$source/tests/faults/virtual.json" "$source/tests/faults/scene.json" "$folder"
    (
        cd "$folder"
        "$bin/simulate" --quiet --scene virtual.json -o truth
        cp truth/loads.csv .
        for n in 0000 0001 0002; do
            "$bin/render" --quiet --scene virtual.json truth/$n.truth.hdf -o photos/$n.tif
        done
        "$bin/findgrains" --quiet --max-flagged 1 --scene scene.json photos/0000.tif -o 0000.grains.hdf
        "$bin/tracker" --quiet --max-flagged 1 --scene scene.json --grains 0000.grains.hdf --reference photos/0000.tif \
            photos/0001.tif -o 0001.tracks.hdf
        "$bin/contacts" --quiet --max-flagged 1 --scene scene.json 0001.tracks.hdf -o 0001.contacts.hdf
        "$bin/forces" --quiet --max-flagged 1 --scene scene.json --method map --start overlap 0001.contacts.hdf \
            -o 0001.forces.hdf
    )
}

# One line per command: its name, a tab, the program with its words. Each writes into out/, nothing else.
tiny_commands() {
    sed 's/ *| */\t/' <<'C'
findgrains | findgrains --max-flagged 1 --scene scene.json photos/0000.tif -o out/0000.grains.hdf
findgrains-picture | findgrains --max-flagged 1 --scene scene.json --picture out/0000.png photos/0000.tif -o out/0000.grains.hdf
tracker | tracker --max-flagged 1 --scene scene.json --grains 0000.grains.hdf --reference photos/0000.tif photos/0001.tif -o out/0001.tracks.hdf
contacts | contacts --max-flagged 1 --scene scene.json 0001.tracks.hdf -o out/0001.contacts.hdf
forces | forces --max-flagged 1 --scene scene.json --method cem,qsm,cdm,map --start overlap 0001.contacts.hdf -o out/0001.forces.hdf
forces-fclib | forces --max-flagged 1 --scene scene.json --method map --fclib out/0001.fclib.hdf5 0001.contacts.hdf -o out/0001.forces.hdf
simulate | simulate --scene virtual.json -o out/truth
render | render --scene virtual.json truth/0001.truth.hdf -o out/0001.tif
map-png | report map 0001.forces.hdf -o out/map.png
map-svg | report map 0001.forces.hdf -o out/map.svg
map-pdf | report map 0001.forces.hdf -o out/map.pdf
page | report page --scene scene.json 0000.grains.hdf 0001.tracks.hdf 0001.contacts.hdf 0001.forces.hdf -o out/report.html
csv | report export --csv 0001.forces.hdf -o out/table.csv
xyz | report export --xyz 0001.forces.hdf -o out/packing.xyz
C
}

# run_command BIN WORDS...: in the series' folder, quietly; its exit status in $status, its words in the files
# stdout and stderr.
run_command() {
    status=0
    "${wrap[@]}" "$1/$2" "${@:3}" --quiet >stdout 2>stderr </dev/null || status=$?
}
wrap=()

# fingerprint FOLDER: the names and contents of all files below it.
fingerprint() { (cd "$1" && find . -type f -print0 | sort -z | xargs -0r sha256sum); }

# left_over FOLDER: files that are no one's result.
left_over() { find "$1" -name '.*.tmp' -printf '%P '; }
