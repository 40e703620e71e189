// Runs the program under test as a process of its own, in a folder that is removed at the end.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

namespace gradus {

/// How a process ended and what it printed.
struct Outcome {
    int exit_code = -1; ///< -1 where a signal ended it
    int signal = 0;     ///< the signal that ended it, or 0
    std::string out, err;
};

class ChildProcess {
  public:
    /// Starts GRADUS_PROGRAM with the arguments in the folder; limits of its files and of its address space in bytes,
    /// 0: none. `ignored`: a signal that it is started to ignore, as by nohup; 0: none.
    ChildProcess(const std::vector<std::string> &arguments, const std::filesystem::path &folder,
                 std::size_t file_size_limit = 0, std::size_t address_limit = 0, int ignored = 0);
    ~ChildProcess();
    ChildProcess(const ChildProcess &) = delete;
    ChildProcess &operator=(const ChildProcess &) = delete;

    void send(int signal) const;
    /// Waits until it has a handler for the signal; ten seconds at most.
    void wait_until_it_hears(int signal) const;
    /// Waits for its end. A process that takes more than a minute is killed.
    Outcome wait();

  private:
    pid_t process_ = -1;
    std::filesystem::path out_, err_;
};

class ProgramTest : public ::testing::Test {
  protected:
    void SetUp() override;
    void TearDown() override;

    Outcome run(const std::vector<std::string> &arguments, std::size_t file_size_limit = 0,
                std::size_t address_limit = 0) const;
    std::string at(const std::string &name) const { return (folder / name).string(); }
    std::string text_of(const std::string &name) const;
    /// Names of the files in the folder, hidden ones too, sorted.
    std::vector<std::string> files() const;
    /// Waits until the file is there; false after ten seconds.
    bool wait_for_file(const std::string &name) const;
    /// Whether there is an oclgrind; it is to run then. For tests whose program is `env`, which finds it on the path.
    bool has_oclgrind() const;

    std::filesystem::path folder;  ///< where the program runs; holds scene.xml, of no content
    std::filesystem::path printed; ///< where its output goes
};

} // namespace gradus
