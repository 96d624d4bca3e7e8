# What pipeline/demo and tests/run share; sourced by them. Sets `root`, the folder of the repository.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

# say WORDS...: one line about what is going on.
say() { printf '\n== %s\n' "$*"; }

# The packages of packages.txt that are not installed.
missing_packages() {
    local package
    while read -r package _; do
        [[ -z $package || $package == \#* ]] ||
            [[ $(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null) == installed ]] || echo "$package"
    done <"$root/packages.txt"
}

# Install them, as root or through sudo; else say the command.
install_packages() {
    local missing as_root=()
    mapfile -t missing < <(missing_packages)
    ((${#missing[@]})) || return 0
    command -v apt-get >/dev/null || { echo "install these packages of Debian 12 first: ${missing[*]}" >&2; exit 1; }
    if ((EUID)); then
        command -v sudo >/dev/null ||
            { echo "packages are missing, run as root: apt-get install ${missing[*]}" >&2; exit 1; }
        as_root=(sudo)
    fi
    say "installing ${missing[*]}"
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -q
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"
}

# build TARGET FOLDER CMAKE-OPTIONS...: configure and compile (target: programs, all); the last lines are shown when it
# fails.
build() {
    local target=$1 folder=$2 log=$2/build.log
    shift 2
    say "building in $folder (log: $log)"
    mkdir -p "$folder"
    if ! { cmake -S "$root" -B "$folder" "$@" && cmake --build "$folder" --target "$target" --parallel "$(nproc)"; } >"$log" 2>&1; then
        tail -n 40 "$log" >&2
        exit 1
    fi
}
