/* A state file, byte for byte, is read or refused with one line, table by table and as a whole packing. */
#include "tests/fuzz/state_reader.h"
#include "tests/fuzz/target.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    read_state_file(fuzz_named_file(data, size));
    return 0;
}
