// gradus-compile: compiles kernels for another process of Gradus, which starts it and talks to it by its standard
// input.
#include "runtime/device/compile_job.h"

#include <malloc.h>
#include <sys/socket.h>

#include <cstdio>

namespace {

/// A worker compiles one kernel after the other, and each needs the memory of the last: giving it back to the system
/// between them costs 5 % of the time.
void keep_freed_memory() {
#ifdef __GLIBC__
    mallopt(M_MMAP_THRESHOLD, 32 << 20); // the most that glibc takes
    mallopt(M_TRIM_THRESHOLD, 1 << 30);
    mallopt(M_TOP_PAD, 32 << 20);
#endif
}

} // namespace

int main() {
    int type = 0;
    socklen_t size = sizeof type;
    if (getsockopt(0, SOL_SOCKET, SO_TYPE, &type, &size) != 0) {
        std::fputs("gradus-compile is started by gradus, to compile kernels\n", stderr);
        return 2;
    }
    keep_freed_memory();
    return gradus::run_compile_worker(0);
}
