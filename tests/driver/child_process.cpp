#include "tests/driver/child_process.h"

#include "runtime/device/spawn_arguments.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <fstream>
#include <sstream>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace gradus {
namespace {

namespace fs = std::filesystem;

std::string read_all(const fs::path &path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

fs::path printed_folder(const fs::path &folder) { return folder.string() + "-printed"; }

} // namespace

ChildProcess::ChildProcess(const std::vector<std::string> &arguments, const fs::path &folder,
                           std::size_t file_size_limit, std::size_t address_limit, int ignored) {
    static int count = 0;
    out_ = printed_folder(folder) / ("out" + std::to_string(count));
    err_ = printed_folder(folder) / ("err" + std::to_string(count++));
    std::vector<std::string> words = arguments;
    words.insert(words.begin(), GRADUS_PROGRAM);
    const std::vector<char *> pointers = pointers_to(words);
    process_ = ::fork();
    if (process_ != 0)
        return;
    // The test may itself run where these are ignored.
    for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGCHLD})
        std::signal(number, number == ignored ? SIG_IGN : SIG_DFL);
    const int out = ::open(out_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    const int err = ::open(err_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ::dup2(out, 1);
    ::dup2(err, 2);
    const auto set_limit = [](int resource, std::size_t bytes) {
        struct rlimit limit = {};
        getrlimit(resource, &limit);
        limit.rlim_cur = bytes;
        if (bytes > 0)
            setrlimit(resource, &limit);
    };
    set_limit(RLIMIT_FSIZE, file_size_limit);
    set_limit(RLIMIT_AS, address_limit);
    if (::chdir(folder.c_str()) == 0)
        ::execv(GRADUS_PROGRAM, pointers.data());
    ::_exit(126);
}

ChildProcess::~ChildProcess() {
    if (process_ > 0) {
        ::kill(process_, SIGKILL);
        ::waitpid(process_, nullptr, 0);
    }
}

void ChildProcess::wait_until_it_hears(int signal) const {
    for (int tries = 0; tries < 1000; ++tries) {
        std::ifstream status("/proc/" + std::to_string(process_) + "/status");
        for (std::string line; std::getline(status, line);)
            if (line.starts_with("SigCgt:") && (std::stoull(line.substr(7), nullptr, 16) >> (signal - 1) & 1) != 0)
                return;
        usleep(10'000);
    }
}

void ChildProcess::send(int signal) const { ::kill(process_, signal); }

Outcome ChildProcess::wait() {
    int status = 0;
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(240);
    while (::waitpid(process_, &status, WNOHANG) == 0) {
        if (std::chrono::steady_clock::now() > deadline)
            ::kill(process_, SIGKILL);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    process_ = -1;
    Outcome outcome;
    if (WIFEXITED(status))
        outcome.exit_code = WEXITSTATUS(status);
    else
        outcome.signal = WTERMSIG(status);
    outcome.out = read_all(out_);
    outcome.err = read_all(err_);
    return outcome;
}

void ProgramTest::SetUp() {
    std::string name = (fs::temp_directory_path() / "gradus-program-XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder = name;
    printed = printed_folder(folder);
    fs::create_directory(printed);
    std::ofstream(folder / "scene.xml") << "<scene version='3.0.0'/>\n";
}

void ProgramTest::TearDown() {
    fs::remove_all(folder);
    fs::remove_all(printed);
}

Outcome ProgramTest::run(const std::vector<std::string> &arguments, std::size_t file_size_limit,
                         std::size_t address_limit) const {
    return ChildProcess(arguments, folder, file_size_limit, address_limit).wait();
}

std::string ProgramTest::text_of(const std::string &name) const { return read_all(folder / name); }

std::vector<std::string> ProgramTest::files() const {
    std::vector<std::string> names;
    for (const fs::directory_entry &entry : fs::directory_iterator(folder))
        names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

bool ProgramTest::has_oclgrind() const {
    const Outcome version = run({"oclgrind", "--version"});
    constexpr int not_found = 127;
    EXPECT_TRUE(version.exit_code == 0 || version.exit_code == not_found) << version.err;
    return version.exit_code != not_found;
}

bool ProgramTest::wait_for_file(const std::string &name) const {
    for (int i = 0; i < 5000; ++i) {
        if (fs::exists(folder / name))
            return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
}

} // namespace gradus
