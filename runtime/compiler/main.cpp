// gradus-compile: compiles kernels for another process of Gradus, which starts it and talks to it by its standard
// input.
#include "runtime/device/compile_job.h"

#include <sys/socket.h>

#include <cstdio>

int main() {
    int type = 0;
    socklen_t size = sizeof type;
    if (getsockopt(0, SOL_SOCKET, SO_TYPE, &type, &size) != 0) {
        std::fputs("gradus-compile is started by gradus, to compile kernels\n", stderr);
        return 2;
    }
    return gradus::run_compile_worker(0);
}
