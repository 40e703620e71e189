// The folder of programs: damage, bounds, and several processes.
#include "runtime/device/program_store.h"

#include <gmock/gmock.h>

#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace gradus {
namespace {

namespace fs = std::filesystem;

ProgramImage image_of_size(std::size_t bytes, char fill) {
    return {{{"first", {{"count", "uint"}, {"film", "real*"}}}, {"second", {}}}, std::string(bytes, fill)};
}

class Store : public ::testing::Test {
  protected:
    void TearDown() override { fs::remove_all(folder); }

    std::string content(const std::string &key) const {
        std::ifstream file(store.file_of(key), std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    void write(const std::string &key, const std::string &content) const {
        std::ofstream(store.file_of(key), std::ios::binary) << content;
    }
    /// It is not used, and gone.
    void expect_thrown_away(const std::string &key, const std::string &what) const {
        EXPECT_FALSE(store.find(key)) << what;
        EXPECT_FALSE(fs::exists(store.file_of(key))) << what;
    }
    std::size_t files() const {
        return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
    }

    const fs::path folder = fs::path(::testing::TempDir()) / ("gradus-store-" + std::to_string(getpid()));
    const ProgramStore store{folder};
};

TEST_F(Store, GivesBackWhatWasPut) {
    EXPECT_FALSE(store.find("key"));
    const ProgramImage image = image_of_size(1000, 'x');
    store.put("key", image);
    const auto found = store.find("key");
    ASSERT_TRUE(found);
    EXPECT_EQ(found->binary, image.binary);
    EXPECT_EQ(found->kernels, image.kernels);
    EXPECT_FALSE(store.find("another key"));
    EXPECT_EQ(files(), 1u) << "no temporary file stays";
}

TEST_F(Store, ThrowsAwayWhatIsCutOff) {
    store.put("key", image_of_size(200, 'x'));
    const std::string whole = content("key");
    for (std::size_t length = 0; length < whole.size(); ++length) {
        write("key", whole.substr(0, length));
        expect_thrown_away("key", std::to_string(length) + " bytes of it");
    }
    write("key", whole + '\0');
    expect_thrown_away("key", "a byte more");
}

TEST_F(Store, ThrowsAwayWhatHasAFlippedBit) {
    store.put("key", image_of_size(200, 'x'));
    const std::string whole = content("key");
    for (std::size_t bit = 0; bit < 8 * whole.size(); bit += 7) {
        std::string damaged = whole;
        damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
        write("key", damaged);
        expect_thrown_away("key", "bit " + std::to_string(bit));
    }
}

TEST_F(Store, ThrowsAwayTheProgramOfAnotherKey) {
    store.put("one", image_of_size(200, 'x'));
    fs::rename(store.file_of("one"), store.file_of("other"));
    expect_thrown_away("other", "the file of another key");
}

/// Which a reader would never come to the end of.
TEST_F(Store, ThrowsAwayWhatIsNoFile) {
    fs::create_directories(folder);
    fs::create_symlink("/dev/zero", store.file_of("key"));
    expect_thrown_away("key", "a link to a device");
    ASSERT_EQ(mkfifo(store.file_of("key").c_str(), 0600), 0);
    expect_thrown_away("key", "a pipe");
}

TEST_F(Store, KnowsAliases) {
    EXPECT_FALSE(store.find_alias("long key"));
    store.put_alias("long key", "key");
    EXPECT_EQ(store.find_alias("long key"), "key");
    EXPECT_FALSE(store.find("long key")) << "no program by itself";
    fs::rename(store.alias_file_of("long key"), store.alias_file_of("other"));
    EXPECT_FALSE(store.find_alias("other")) << "the file of another key";
    store.put_alias("other", "key");
    EXPECT_EQ(store.find_alias("other"), "key") << "written anew";
    fs::resize_file(store.alias_file_of("other"), fs::file_size(store.alias_file_of("other")) - 1);
    EXPECT_FALSE(store.find_alias("other")) << "cut off";
    fs::last_write_time(store.alias_file_of("other"), fs::file_time_type::clock::now() - std::chrono::hours(2));
    const ProgramStore tiny(folder, 0);
    tiny.trim();
    EXPECT_EQ(files(), 0u) << "they count";
}

TEST_F(Store, KeepsNothingWhereItMayNotWrite) {
    fs::create_directories(folder);
    std::ofstream(folder / "file") << "in the way of a folder";
    const ProgramStore nowhere(folder / "file" / "programs");
    EXPECT_NO_THROW(nowhere.put("key", image_of_size(10, 'x')));
    EXPECT_FALSE(nowhere.find("key"));
    EXPECT_NO_THROW(nowhere.trim());
    const ProgramStore off;
    EXPECT_NO_THROW(off.put("key", image_of_size(10, 'x')));
    EXPECT_NO_THROW(off.put_alias("long key", "key"));
    EXPECT_FALSE(off.find_alias("long key"));
    EXPECT_FALSE(off.find("key"));
}

/// Runs a function in a process of its own; its exit status.
template <class Function>
pid_t start_process(Function function) {
    const pid_t process = fork();
    if (process == 0)
        _exit(function());
    return process;
}

int end_of(pid_t process) {
    int status = -1;
    waitpid(process, &status, 0);
    return status;
}

// A full disk, as a limit to the size of files: the write ends early with an error.
TEST_F(Store, LeavesNothingBehindOnAFullDisk) {
    const pid_t process = start_process([&] {
        const std::uint64_t before = programs_not_kept();
        std::signal(SIGXFSZ, SIG_IGN);
        const rlimit limit = {500, 500};
        setrlimit(RLIMIT_FSIZE, &limit);
        store.put("key", image_of_size(1000, 'x'));
        return store.find("key") || programs_not_kept() != before + 1 ? 1 : 0;
    });
    EXPECT_EQ(end_of(process), 0);
    EXPECT_EQ(files(), 0u);
}

TEST_F(Store, StaysBelowItsLimit) {
    const ProgramStore small(folder, 3500);
    const auto put_aged = [&](const std::string &key, int hours) {
        small.put(key, image_of_size(1000, key[0]));
        fs::last_write_time(small.file_of(key), fs::file_time_type::clock::now() - std::chrono::hours(hours));
    };
    put_aged("a", 5);
    put_aged("b", 4);
    put_aged("c", 3);
    put_aged("d", 2);
    ASSERT_TRUE(small.find("a")) << "now it was used last";
    const std::string number = small.file_of("a").stem();
    const std::vector<std::string> others = {"not ours",           ".alias",         "notes.program.tar",
                                             number + ".program~", "x.unfinished-1", number + "0.program"};
    for (const std::string &name : others) {
        std::ofstream(folder / name) << std::string(9000, 'x');
        fs::last_write_time(folder / name, fs::file_time_type::clock::now() - std::chrono::hours(9));
    }
    small.trim();
    EXPECT_FALSE(small.find("b"));
    EXPECT_TRUE(small.find("a"));
    EXPECT_TRUE(small.find("d"));
    for (const std::string &name : others)
        EXPECT_TRUE(fs::exists(folder / name)) << name;
}

TEST_F(Store, DeletesWhatAKilledProcessLeft) {
    store.put("key", image_of_size(10, 'x'));
    const fs::path old = store.file_of("key").string() + ".unfinished-abcdef", young = old.string() + "g";
    std::ofstream(old) << "part";
    std::ofstream(young) << "part";
    fs::last_write_time(old, fs::file_time_type::clock::now() - std::chrono::hours(2));
    store.trim();
    EXPECT_FALSE(fs::exists(old));
    EXPECT_TRUE(fs::exists(young)) << "another process may be writing it";
    EXPECT_TRUE(store.find("key"));
}

// Readers see a whole program or none, whatever others put, remove and trim at the time.
TEST_F(Store, ServesSeveralProcessesAtOnce) {
    const auto work = [&](int number) {
        const ProgramStore shared(folder, 1000000);
        for (int round = 0; round < 100; ++round) {
            shared.put("again", image_of_size(100000, 'x'));
            if (!shared.find("again"))
                return 2; // half of another one's was seen
            for (const char key : {'a', 'b', 'c'}) {
                const auto found = shared.find({key});
                if (found && found->binary != std::string(100000 + key, key))
                    return 1;
                if (!found || round % 4 == number)
                    shared.put({key}, image_of_size(100000 + key, key));
                if (round % 10 == number)
                    shared.remove({key});
                if (round % 25 == number)
                    shared.trim();
            }
        }
        return 0;
    };
    std::vector<pid_t> processes;
    for (int i = 0; i < 4; ++i)
        processes.push_back(start_process([&] { return work(i); }));
    for (const pid_t process : processes)
        EXPECT_EQ(end_of(process), 0);
    for (const auto &file : fs::directory_iterator(folder))
        EXPECT_THAT(file.path().string(), ::testing::EndsWith(".program")) << "nothing unfinished";
}

} // namespace
} // namespace gradus
