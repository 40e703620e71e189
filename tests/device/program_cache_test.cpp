// Kernels from the store of programs against kernels that were compiled.
#include "runtime/device/cache_folder.h"
#include "runtime/device/compile_workers.h"
#include "runtime/device/kernel_source.h"
#include "runtime/device/opencl.h"
#include "runtime/device/program.h"
#include "runtime/device/program_key.h"
#include "runtime/error.h"

#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <thread>
#include <unistd.h>
#include <vector>

namespace gradus {
namespace {

namespace fs = std::filesystem;

/// A variable of the environment, until it is destroyed.
class Variable {
  public:
    Variable(const char *name, const std::string &value) : name_(name) {
        if (const char *before = std::getenv(name))
            before_ = before;
        setenv(name, value.c_str(), 1);
    }
    ~Variable() {
        if (before_)
            setenv(name_, before_->c_str(), 1);
        else
            unsetenv(name_);
    }

  private:
    const char *name_;
    std::optional<std::string> before_;
};

KernelRequest scan_of(int chunk) {
    return {"scan " + std::to_string(chunk),
            "kernels/stages/partition.cl",
            "partition_scan",
            {{"PARTITION_CHUNK", std::to_string(chunk)}}};
}

std::vector<std::uint32_t> run_scan(Device &device, Kernel kernel) {
    const std::vector<std::uint32_t> counts = {3, 1, 4, 1, 5, 9}, zeros(8);
    const Buffer offset(device, "chunk_offset", counts.data(), 24), range(device, "range", zeros.data(), 32);
    kernel.bind(offset);
    kernel.bind(range);
    kernel.set("count", 1);
    kernel.set("bins", 3);
    kernel.set("chunks", 2);
    kernel.launch(1);
    std::vector<std::uint32_t> result(8);
    range.read(result.data(), 32);
    return result;
}

/// How many kernels PoCL has code of in its folder.
std::size_t pocl_libraries() {
    // A device with workers has named a folder where nobody else has; else PoCL takes its own.
    const auto variable = [](const char *name) { return std::getenv(name) ? fs::path(std::getenv(name)) : fs::path(); };
    const fs::path cache =
        variable("XDG_CACHE_HOME").empty() ? variable("HOME") / ".cache" : variable("XDG_CACHE_HOME");
    const fs::path folder = variable("POCL_CACHE_DIR").empty() ? cache / "pocl" : variable("POCL_CACHE_DIR");
    std::size_t count = 0;
    if (fs::exists(folder))
        for (const auto &file : fs::recursive_directory_iterator(folder))
            count += file.path().extension() == ".so";
    return count;
}

class ProgramCache : public ::testing::Test {
  protected:
    void TearDown() override { fs::remove_all(folder); }

    struct Outcome {
        std::vector<std::uint32_t> result;
        std::size_t compiled;
    };
    /// As a new process would: with a device that has built nothing yet.
    static Outcome build_and_run(int chunk = 4) {
        Device device;
        const Kernel kernel = KernelLibrary(device, {}).build({scan_of(chunk)})[0];
        return {run_scan(device, kernel), device.implementation().compiled.load()};
    }
    std::vector<fs::path> entries() const {
        std::vector<fs::path> found;
        for (const auto &file : fs::directory_iterator(folder))
            if (file.path().extension() == ".program")
                found.push_back(file.path());
        return found;
    }

    const fs::path folder = fs::path(::testing::TempDir()) / ("gradus-cache-" + std::to_string(getpid()));
    const Variable in_folder{"GRADUS_CACHE_DIR", folder.string()};
    const ::testing::Matcher<std::vector<std::uint32_t>> right = ::testing::ElementsAre(0, 4, 9, 23, 0, 0, 0, 0);
};

TEST_F(ProgramCache, IsUsedAgain) {
    const Outcome first = build_and_run(), second = build_and_run();
    EXPECT_EQ(first.compiled, 1u);
    EXPECT_EQ(second.compiled, 0u);
    EXPECT_THAT(first.result, right);
    EXPECT_EQ(first.result, second.result);
    EXPECT_EQ(build_and_run(8).compiled, 1u) << "other options, another program";
    EXPECT_EQ(entries().size(), 2u);
}

// Traits of the scene that a kernel does not use make no kernel of their own, in this process and in others.
TEST_F(ProgramCache, ServesWhatDiffersInWhatIsNotUsed) {
    KernelRequest request = scan_of(4);
    const auto compiled_with = [&](const std::string &name, const std::string &value) {
        request.definitions[name] = value;
        Device device;
        EXPECT_THAT(run_scan(device, KernelLibrary(device, {}).build({request})[0]), right) << name;
        return device.implementation().compiled.load();
    };
    EXPECT_EQ(compiled_with("TRAIT_OF_NOBODY", "0"), 1u);
    EXPECT_EQ(compiled_with("TRAIT_OF_NOBODY", "1"), 0u);
    EXPECT_EQ(entries().size(), 1u);
    // The long way again, where the alias points to what was thrown away.
    fs::remove(entries()[0]);
    EXPECT_EQ(compiled_with("TRAIT_OF_NOBODY", "1"), 1u);
    EXPECT_EQ(compiled_with("TRAIT_OF_NOBODY", "0"), 0u);
}

TEST_F(ProgramCache, RebuildsWhatIsDamaged) {
    build_and_run();
    ASSERT_EQ(entries().size(), 1u);
    fs::resize_file(entries()[0], fs::file_size(entries()[0]) / 2);
    const Outcome again = build_and_run();
    EXPECT_EQ(again.compiled, 1u);
    EXPECT_THAT(again.result, right);
    EXPECT_EQ(build_and_run().compiled, 0u) << "and it is kept again";
}

// A whole entry that the device does not take: of an implementation that changed without a new name.
TEST_F(ProgramCache, RebuildsWhatTheDeviceRefuses) {
    Device device;
    KernelLibrary(device, {}).build({scan_of(4)});
    ASSERT_EQ(entries().size(), 1u);
    // The key is not at hand here: the entry is written by a store whose find() has checked it.
    const ProgramStore store(folder);
    std::string key;
    for (const auto &[name, program] : device.implementation().built.programs) {
        const std::size_t end = name.find('\n');
        key = program_key(device_key(device.description()), name.substr(0, end), kernel_source(scan_of(4).file).text);
    }
    key = store.find_alias(key).value();
    auto image = store.find(key);
    ASSERT_TRUE(image);
    const ProgramImage good = *image;
    image->binary = "not code at all, and long enough to have a head like the code of other implementations has";
    store.put(key, *image);
    {
        // It may be whole, and refused for want of memory or of a disk's room: it stays until there is another.
        const Variable none("GRADUS_COMPILE", "/bin/false");
        EXPECT_EQ(build_and_run().compiled, 1u);
        EXPECT_TRUE(store.find(key));
    }
    EXPECT_EQ(build_and_run().compiled, 1u);
    EXPECT_EQ(store.find(key)->kernels, good.kernels);
    image = good;
    image->kernels.begin()->second.pop_back();
    store.put(key, *image);
    EXPECT_EQ(build_and_run().compiled, 1u) << "a kernel with another number of arguments";
}

TEST_F(ProgramCache, NeedsNoCompilerAtTheFirstLaunch) {
    if (!is_pocl_cpu(Device().description()))
        GTEST_SKIP() << "of other implementations nothing is known";
    const KernelRequest request = scan_of(100 + getpid());
    {
        Device device;
        KernelLibrary(device, {}).build({request});
    }
    Device device;
    const Kernel kernel = KernelLibrary(device, {}).build({request})[0];
    const std::size_t before = pocl_libraries();
    EXPECT_THAT(run_scan(device, kernel), right);
    EXPECT_EQ(pocl_libraries(), before) << "PoCL compiled at the launch";
}

/// Those are of a size that no render has, so the code is not kept; what it is made of is.
TEST_F(ProgramCache, CompilesForOtherLaunchesFromWhatIsKept) {
    if (!is_pocl_cpu(Device().description()))
        GTEST_SKIP() << "other implementations have one code for all launches";
    const KernelRequest request = {
        "count", "kernels/stages/partition.cl", "partition_count", {{"PARTITION_CHUNK", std::to_string(4 + getpid())}}};
    {
        Device device;
        KernelLibrary(device, {}).build({request});
    }
    Device device;
    Kernel kernel = KernelLibrary(device, {}).build({request})[0];
    ASSERT_EQ(device.implementation().compiled, 0u);
    const std::vector<std::uint32_t> bins = {0, 1, 1, 0, 2, 1}, zeros(3);
    const Buffer bin(device, "bin", bins.data(), 24), counts(device, "chunk_offset", zeros.data(), 12);
    kernel.bind(bin);
    kernel.bind(counts);
    kernel.set("count", 1);
    kernel.set("rows", 6);
    kernel.set("bins", 3);
    const std::size_t before = pocl_libraries();
    kernel.launch(1, 70000); // more than the 16 bits that PoCL has code for
    std::vector<std::uint32_t> found(3);
    counts.read(found.data(), 12);
    EXPECT_THAT(found, ::testing::ElementsAre(2, 3, 1));
    EXPECT_GT(pocl_libraries(), before) << "the launch was like others";
}

TEST_F(ProgramCache, IsFilledBySeveralWorkers) {
    Device device("", 3);
    for (const char *variable : pocl_thread_variables)
        EXPECT_STREQ(std::getenv(variable), "3") << variable;
    std::vector<KernelRequest> requests;
    for (const int chunk : {1, 2, 4, 8})
        requests.push_back(scan_of(chunk));
    requests.push_back(requests[0]);
    std::size_t calls = 0;
    const auto kernels =
        KernelLibrary(device, {})
            .build(requests, [&](const std::string &, std::size_t built, std::size_t of, double seconds) {
                EXPECT_EQ(built, ++calls);
                EXPECT_EQ(of, 5u);
                EXPECT_GE(seconds, 0);
            });
    EXPECT_EQ(calls, 5u);
    EXPECT_EQ(device.implementation().compiled, 4u);
    EXPECT_EQ(entries().size(), 4u);
    for (const Kernel &kernel : kernels)
        EXPECT_THAT(run_scan(device, kernel), right);
    for (const auto &file : fs::directory_iterator(private_folder()))
        EXPECT_THAT(file.path().filename().string(), ::testing::Not(::testing::StartsWith("worker"))) << "left behind";
}

TEST_F(ProgramCache, CompilesItselfWhereNoWorkerDoes) {
    if (!is_pocl_cpu(Device().description()))
        GTEST_SKIP() << "only PoCL has workers";
    for (const char *worker : {"/no/such/program", "/bin/false", "/bin/true"}) {
        const Variable chosen("GRADUS_COMPILE", worker);
        const Outcome outcome = build_and_run();
        EXPECT_EQ(outcome.compiled, 1u) << worker;
        EXPECT_THAT(outcome.result, right) << worker;
    }
}

/// As where its disk is full, which is no error of the kernel.
TEST_F(ProgramCache, CompilesItselfWhereAWorkerCannotWrite) {
    if (!is_pocl_cpu(Device().description()))
        GTEST_SKIP() << "only PoCL has workers";
    fs::create_directories(folder);
    const std::string worker = folder / "worker";
    std::ofstream(worker) << "#!/bin/sh\ntrap '' XFSZ\nulimit -f 0\nexec " << compile_worker_program().string() << '\n';
    fs::permissions(worker, fs::perms::owner_all);
    const Variable chosen("GRADUS_COMPILE", worker);
    const Outcome outcome = build_and_run();
    EXPECT_EQ(outcome.compiled, 1u);
    EXPECT_THAT(outcome.result, right);
}

TEST(CacheFolder, IsTheFirstWithRoomElseTheRoomiest) {
    const auto chosen = [](const std::vector<double> &rooms) {
        std::vector<fs::path> folders;
        for (std::size_t i = 0; i < rooms.size(); ++i)
            folders.push_back(std::to_string(i));
        return folder_with_room(folders, [&](const fs::path &path) { return rooms[std::stoul(path.string())]; });
    };
    EXPECT_EQ(chosen({0.9, 1, 5}), "1");
    EXPECT_EQ(chosen({0.25, 0, 0.5, 0.3}), "2");
    EXPECT_EQ(chosen({0, 0}), "");
}

/// PoCL waits for its linker, and would not learn how that ends: neither here nor in a worker.
TEST_F(ProgramCache, IsFilledWhereTheEndsOfProcessesAreIgnored) {
    const auto before = std::signal(SIGCHLD, SIG_IGN);
    const Outcome outcome = build_and_run(32);
    std::signal(SIGCHLD, before);
    EXPECT_EQ(entries().size(), is_pocl_cpu(Device().description()) ? 1u : entries().size());
    EXPECT_THAT(outcome.result, right);
}

/// Ctrl-C and `timeout` send their signals to all processes of a group, a worker's linker among them.
TEST_F(ProgramCache, IsFilledWhereSignalsReachTheLinker) {
    if (!is_pocl_cpu(Device().description()))
        GTEST_SKIP() << "only PoCL has workers";
    fs::create_directories(folder);
    std::ofstream(folder / "ld") << "#!/bin/sh\ntouch " << folder / "linked"
                                 << "\nkill -INT $$\nkill -TERM $$\nkill -HUP $$\nPATH=${PATH#*:} exec ld \"$@\"\n";
    fs::permissions(folder / "ld", fs::perms::owner_all);
    const Variable path("PATH", folder.string() + ':' + std::getenv("PATH"));
    const Outcome outcome = build_and_run();
    EXPECT_TRUE(fs::exists(folder / "linked"));
    EXPECT_EQ(entries().size(), 1u) << "no worker compiled it";
    EXPECT_THAT(outcome.result, right);
}

// One says nothing at all; the other stops within its answer.
TEST_F(ProgramCache, CompilesItselfWhereAWorkerHangs) {
    if (!is_pocl_cpu(Device().description()))
        GTEST_SKIP() << "only PoCL has workers";
    fs::create_directories(folder);
    const std::string worker = folder / "worker";
    for (const std::string does : {"", "printf '\\377\\0\\0\\0\\0\\0\\0\\0some' >&0; "}) {
        std::ofstream(worker) << "#!/bin/sh\n" << does << "exec sleep 60\n";
        fs::permissions(worker, fs::perms::owner_all);
        const Variable chosen("GRADUS_COMPILE", worker), limit("GRADUS_COMPILE_LIMIT", "1");
        const auto start = std::chrono::steady_clock::now();
        ::testing::internal::CaptureStderr();
        const Outcome outcome = build_and_run();
        const std::string said = ::testing::internal::GetCapturedStderr();
        const auto waited = std::chrono::steady_clock::now() - start;
        EXPECT_GE(waited, std::chrono::seconds(1)) << does;
        EXPECT_LT(waited, std::chrono::seconds(60)) << does << "the worker's own end was waited for";
        EXPECT_EQ(outcome.compiled, 1u) << does;
        EXPECT_THAT(outcome.result, right) << does;
        EXPECT_EQ(said.find("kernel scan 4: the process that compiles it gave no answer in 1 s") != std::string::npos,
                  does.empty())
            << said;
    }
}

/// As at the end of a user's last session, with a kernel that was launched before, one that was not, and one to come.
TEST_F(ProgramCache, IsUnpackedAgainWhereItsFolderIsDeleted) {
    Device device;
    if (!is_pocl_cpu(device.description()))
        GTEST_SKIP() << "only PoCL has such a folder";
    fs::remove_all(private_folder()); // with the code of other tests
    const auto kernels = KernelLibrary(device, {}).build({scan_of(4), scan_of(8)});
    EXPECT_THAT(run_scan(device, kernels[0]), right);
    const std::size_t unpacked = pocl_libraries();
    fs::remove_all(private_folder());
    for (const Kernel &kernel : kernels)
        EXPECT_THAT(run_scan(device, kernel), right);
    // Of some kernels PoCL makes the code anew where it misses it; for others it ends the process.
    EXPECT_EQ(pocl_libraries(), unpacked);
    fs::remove_all(private_folder());
    EXPECT_THAT(run_scan(device, KernelLibrary(device, {}).build({scan_of(2)})[0]), right);
    EXPECT_THAT(run_scan(device, KernelLibrary(device, {}).build({scan_of(16)})[0]), right);
}

std::vector<pid_t> children() {
    std::vector<pid_t> found;
    for (const auto &thread : fs::directory_iterator("/proc/self/task")) {
        std::ifstream list(thread.path() / "children");
        found.insert(found.end(), std::istream_iterator<pid_t>(list), {});
    }
    return found;
}

TEST_F(ProgramCache, KeepsWorkersWhileTheyAreAskedFor) {
    Device device;
    if (!is_pocl_cpu(device.description()))
        GTEST_SKIP() << "only PoCL has workers";
    const auto workers = [] {
        std::vector<std::string> found;
        for (const auto &file : fs::directory_iterator(private_folder()))
            if (file.path().filename().string().starts_with("worker"))
                found.push_back(file.path().filename());
        return found;
    };
    std::shared_ptr<void> kept = keep_compilers(device);
    // They outlive the thread that began them, and Ctrl-C and its like, which are this process's to answer.
    std::thread([&] { KernelLibrary(device, {}).build({scan_of(1)}); }).join();
    const std::vector<std::string> first = workers();
    EXPECT_EQ(first.size(), 1u);
    for (const pid_t child : children())
        for (const int number : {SIGINT, SIGTERM, SIGHUP})
            kill(child, number);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    KernelLibrary(device, {}).build({scan_of(2)});
    EXPECT_EQ(workers(), first);
    kept.reset();
    EXPECT_THAT(workers(), ::testing::IsEmpty());
    KernelLibrary(device, {}).build({scan_of(4)});
    EXPECT_THAT(workers(), ::testing::IsEmpty());
}

TEST_F(ProgramCache, CanBeOffOrOutOfReach) {
    fs::create_directories(folder);
    std::ofstream(folder / "file") << "in the way";
    for (const std::string &value : {std::string("off"), std::string(), (folder / "file" / "programs").string()}) {
        const Variable chosen("GRADUS_CACHE_DIR", value);
        for (int i = 0; i < 2; ++i) {
            const Outcome outcome = build_and_run();
            EXPECT_EQ(outcome.compiled, 1u) << value;
            EXPECT_THAT(outcome.result, right) << value;
        }
    }
    EXPECT_TRUE(entries().empty());
}

TEST_F(ProgramCache, ReportsWhatDoesNotCompileWithAndWithoutWorkers) {
    KernelRequest broken = scan_of(4);
    broken.definitions["PARTITION_CHUNK"] = "no_such_name";
    broken.entry = "partition_count";
    for (const char *folder_or_off : {folder.c_str(), "off"}) {
        const Variable chosen("GRADUS_CACHE_DIR", folder_or_off);
        Device device;
        KernelLibrary library(device, {});
        try {
            library.build({scan_of(4), broken});
            FAIL() << folder_or_off;
        } catch (const Error &error) {
            EXPECT_THAT(error.what(), ::testing::HasSubstr("no_such_name")) << folder_or_off;
            EXPECT_THAT(error.what(), ::testing::HasSubstr("kernels/stages/partition.cl:")) << folder_or_off;
        }
        EXPECT_NO_THROW(library.build({scan_of(4)})) << "what was not compiled for another's error is compiled now";
    }
}

TEST(ProgramCacheOfOthers, DISABLED_IsFilledByThisProcess) {
    for (const int chunk : {1, 2, 4}) {
        Device device;
        EXPECT_THAT(run_scan(device, KernelLibrary(device, {}).build({scan_of(chunk)})[0]),
                    ::testing::ElementsAre(0, 4, 9, 23, 0, 0, 0, 0));
    }
}

// Programs that start at the same time, as a farm starts them, with folders that the first of them makes.
TEST_F(ProgramCache, ServesProgramsThatStartTogether) {
    const std::string program = fs::read_symlink("/proc/self/exe");
    const std::string command = "env -u POCL_CACHE_DIR GRADUS_CACHE_DIR=" + folder.string() + " " + program +
                                " --gtest_also_run_disabled_tests "
                                "--gtest_filter='*DISABLED_IsFilledByThisProcess' >/dev/null 2>&1";
    std::vector<int> ends(3, -1);
    std::vector<std::thread> threads;
    for (int &end : ends)
        threads.emplace_back([&end, &command] { end = std::system(command.c_str()); });
    for (std::thread &thread : threads)
        thread.join();
    EXPECT_THAT(ends, ::testing::Each(0));
    EXPECT_EQ(entries().size(), 3u);
    for (const int chunk : {1, 2, 4})
        EXPECT_EQ(build_and_run(chunk).compiled, 0u);
}

} // namespace
} // namespace gradus
