# Other builds that tests of faults need; sourced by them.

# plain_build SOURCE BUILD: prints a build without sanitizers: BUILD itself, or one made inside it.
plain_build() {
    if grep -q '^FILM_SANITIZE:BOOL=ON' "$2/CMakeCache.txt" 2>/dev/null; then
        cmake -S "$1" -B "$2/plain" -DCMAKE_BUILD_TYPE=Release >/dev/null
        cmake --build "$2/plain" --parallel "$(nproc)" --target programs >/dev/null
        echo "$2/plain"
    else
        echo "$2"
    fi
}

# thread_sanitizer_build SOURCE BUILD: the programs by Clang with ThreadSanitizer, in BUILD/threads.
thread_sanitizer_build() {
    CC=clang CXX=clang++ cmake -S "$1" -B "$2/threads" -DCMAKE_BUILD_TYPE=RelWithDebInfo \
        -DCMAKE_C_FLAGS=-fsanitize=thread -DCMAKE_CXX_FLAGS=-fsanitize=thread -DCMAKE_EXE_LINKER_FLAGS=-fsanitize=thread \
        >/dev/null
    cmake --build "$2/threads" --parallel "$(nproc)" --target programs >/dev/null
}

# watch_threads: what ThreadSanitizer needs to understand OpenMP of Clang (archer); status 77 where it is absent.
watch_threads() {
    local archer
    archer=$(find /usr/lib/llvm-*/lib -name 'libarcher.so' 2>/dev/null | sort | tail -n 1)
    if ! command -v clang >/dev/null || [ -z "$archer" ]; then
        echo "skipped: needs clang and libomp-dev (libarcher.so)"
        exit 77
    fi
    export TSAN_OPTIONS="ignore_noninstrumented_modules=1 exitcode=66" OMP_TOOL_LIBRARIES=$archer
}
