#include "runtime/device/compile_job.h"

#include "runtime/device/build_log.h"
#include "runtime/device/byte_text.h"
#include "runtime/device/framed_socket.h"
#include "runtime/device/pocl_bitcode.h"
#include "runtime/device/pocl_compiler.h"
#include "runtime/device/pocl_linker.h"
#include "runtime/device/pocl_stub.h"
#include "runtime/error.h"
#include "runtime/seconds_since.h"

#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <optional>
#include <thread>

namespace gradus {

std::string to_bytes(const CompileJob &job) {
    ByteWriter writer;
    for (const std::string_view text :
         {compile_protocol, std::string_view(job.device.platform), std::string_view(job.device.name),
          std::string_view(job.device.driver), std::string_view(job.source.name), std::string_view(job.source.text),
          std::string_view(job.source.options)})
        writer.text(text);
    return writer.bytes();
}

CompileJob compile_job(std::string_view bytes) {
    ByteReader reader(bytes);
    if (reader.text() != compile_protocol)
        throw std::runtime_error("a job of another version");
    CompileJob job;
    for (std::string *text : {&job.device.platform, &job.device.name, &job.device.driver, &job.source.name,
                              &job.source.text, &job.source.options})
        *text = reader.text();
    return job;
}

std::string to_bytes(const CompileAnswer &answer) {
    ByteWriter writer;
    writer.text(compile_protocol);
    writer.number(static_cast<std::uint64_t>(answer.kind));
    writer.text(answer.content);
    writer.seconds(answer.seconds);
    return writer.bytes();
}

CompileAnswer compile_answer(std::string_view bytes) {
    ByteReader reader(bytes);
    if (reader.text() != compile_protocol)
        throw std::runtime_error("an answer of another version");
    CompileAnswer answer;
    const std::uint64_t kind = reader.number();
    if (kind > static_cast<std::uint64_t>(CompileAnswer::Kind::no_code))
        throw std::runtime_error("an answer of no kind");
    answer.kind = static_cast<CompileAnswer::Kind>(kind);
    answer.content = reader.text();
    answer.seconds = reader.seconds();
    return answer;
}

namespace {

/// A device that is opened once: an implementation may load its library of built-in functions for each context.
struct OpenDevice {
    cl::Device device;
    cl::Context context;
    PoclStubs stubs;
};

OpenDevice open_device(const DeviceDescription &wanted) {
    const char *variable = std::getenv("POCL_CACHE_DIR");
    const std::string pocl_folder = variable ? variable : "";
    for (const FoundDevice &found : find_devices()) {
        if (found.description.platform != wanted.platform || found.description.name != wanted.name ||
            found.description.driver != wanted.driver)
            continue;
        OpenDevice opened{found.device, cl::Context(found.device), PoclStubs(pocl_folder, wanted)};
        prepare_pocl_linker(pocl_folder, found.description);
        prepare_pocl_compiler(opened.context, opened.device, found.description);
        return opened;
    }
    throw cl::Error(CL_DEVICE_NOT_FOUND, "clGetDeviceIDs");
}

CompileAnswer compile(const CompileJob &job, OpenDevice &opened) {
    try {
        const BuiltProgram program = build_source(opened.context, opened.device, job.source);
        for (const std::filesystem::path &code : opened.stubs.put(program.kernels))
            trim_pocl_bitcode(code);
        return {CompileAnswer::Kind::compiled, to_bytes(image_of(program)), 0};
    } catch (const Error &error) {
        // Where it is this process that cannot compile, the other one is to try, and to say so where it cannot either.
        const bool is_of_source = tells_of_error(error.what());
        return {is_of_source ? CompileAnswer::Kind::does_not_compile : CompileAnswer::Kind::no_code, error.what(), 0};
    } catch (const cl::Error &error) {
        return {CompileAnswer::Kind::no_code, error.what(), 0};
    }
}

} // namespace

int run_compile_worker(int socket) {
    std::signal(SIGCHLD, SIG_DFL); // or PoCL would not learn how its linker ends
    // Ctrl-C and what batch systems send to all are for the other process, which may still need kernels for its last
    // image. Blocked and not ignored: LLVM puts handlers of its own in the place of SIG_IGN, and a linker begins
    // without either. Threads and programs that are started from here have them blocked, too.
    sigset_t blocked;
    sigemptyset(&blocked);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP})
        sigaddset(&blocked, signal);
    sigprocmask(SIG_BLOCK, &blocked, nullptr);
    // Nobody waits for what is compiled when the other process is gone. (PR_SET_PDEATHSIG would end this one with the
    // thread that began it.)
    std::thread([socket] {
        pollfd other = {socket, 0, 0};
        while (poll(&other, 1, -1) < 0) {
        }
        _exit(0);
    }).detach();
    std::optional<OpenDevice> opened;
    std::string message;
    while (receive_message(socket, message)) {
        const auto start = std::chrono::steady_clock::now();
        CompileAnswer answer;
        try {
            const CompileJob job = compile_job(message);
            if (!opened) // an error of this one is none of the source
                opened.emplace(open_device(job.device));
            answer = compile(job, *opened);
        } catch (const std::exception &error) {
            answer = {CompileAnswer::Kind::no_code, error.what(), 0};
        }
        answer.seconds = seconds_since(start);
        if (!send_message(socket, to_bytes(answer)))
            break;
    }
    return 0;
}

} // namespace gradus
