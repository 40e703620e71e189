#include "runtime/device/program_builder.h"

#include "runtime/device/cache_folder.h"
#include "runtime/device/compile_workers.h"
#include "runtime/device/hash.h"
#include "runtime/device/needed_source.h"
#include "runtime/device/program_key.h"
#include "runtime/error.h"
#include "runtime/seconds_since.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

namespace gradus {

namespace {

using Clock = std::chrono::steady_clock;
using Shared = std::shared_ptr<const BuiltProgram>;

/// Programs that this call makes, while others that ask for them wait.
class Claims {
  public:
    explicit Claims(BuiltPrograms &built) : built_(built) {}
    ~Claims() {
        // What was not made may be asked for again.
        const std::lock_guard lock(built_.mutex);
        for (auto &[name, promise] : open_) {
            promise.set_exception(std::make_exception_ptr(Error(ExitCode::device, "another kernel does not compile")));
            built_.programs.erase(name);
        }
    }
    Claims(const Claims &) = delete;
    Claims &operator=(const Claims &) = delete;

    /// Its program, now or later; `is_mine` where this call is to make it.
    std::shared_future<Shared> claim(const std::string &name, bool &is_mine) {
        const std::lock_guard lock(built_.mutex);
        auto [found, is_new] = built_.programs.try_emplace(name);
        if (is_new)
            found->second = open_[name].get_future().share();
        is_mine = is_new;
        return found->second;
    }
    void fulfil(const std::string &name, Shared program) {
        const std::lock_guard lock(built_.mutex);
        open_.at(name).set_value(std::move(program));
        open_.erase(name);
    }

  private:
    BuiltPrograms &built_;
    std::map<std::string, std::promise<Shared>> open_;
};

/// A program that this call makes.
struct Task {
    std::size_t index;    ///< of its source
    std::string name;     ///< among those of this process
    std::string key;      ///< in the store; empty: it is not kept
    ProgramSource source; ///< what is compiled
};

class Builder {
  public:
    Builder(Device::Implementation &device, const std::vector<ProgramSource> &sources, std::uint32_t work_group_size,
            const ProgramReady &ready)
        : device_(device), sources_(sources), work_group_size_(work_group_size), ready_(ready), claims_(device.built) {}

    std::vector<Shared> build() {
        std::vector<Task> missing;
        std::vector<std::shared_future<Shared>> programs;
        std::vector<std::size_t> made_elsewhere;
        std::string device; // its key asks the system, so only where there is something to look for
        for (std::size_t i = 0; i < sources_.size(); ++i) {
            // Not the text itself, of which each comparison would read all.
            const std::string name = sources_[i].options + '\n' + hexadecimal(hash128(sources_[i].text, 0));
            bool is_mine = false;
            programs.push_back(claims_.claim(name, is_mine));
            if (!is_mine) {
                made_elsewhere.push_back(i);
                continue;
            }
            if (device.empty() && device_.store.is_on())
                device = device_key(device_.description);
            Task task{i, name, "", {}};
            if (!take_stored(task, device))
                missing.push_back(std::move(task));
        }
        compile(missing);
        std::vector<Shared> result;
        for (const std::shared_future<Shared> &program : programs)
            result.push_back(program.get());
        for (const std::size_t i : made_elsewhere)
            ready_(i, 0);
        return result;
    }

  private:
    /// Makes it known. One call at a time.
    void finish(const Task &task, BuiltProgram &&program, double seconds) {
        const std::lock_guard lock(finishing_);
        claims_.fulfil(task.name, std::make_shared<const BuiltProgram>(std::move(program)));
        ready_(task.index, seconds);
    }

    /// False where the device does not take the image.
    bool take_image(const Task &task, const ProgramImage &image, double seconds) {
        std::optional<BuiltProgram> program;
        try {
            program = compiler_call(device_, "loading " + sources_[task.index].name, [&] {
                return load_image(device_.context, device_.device, image, sources_[task.index].options);
            });
        } catch (const Error &) {
            return false;
        }
        program->key = task.key;
        program->options = sources_[task.index].options;
        finish(task, std::move(*program), seconds);
        return true;
    }

    /// Else says what is to be compiled, and under which key it is kept.
    bool take_stored(Task &task, const std::string &device) {
        const ProgramSource &source = sources_[task.index];
        const std::string whole_key = device.empty() ? "" : program_key(device, source.options, source.text);
        // The short way, as preprocessing takes time: it was done before, or was of no use.
        task.key = device_.store.find_alias(whole_key).value_or(whole_key);
        if (take_entry(task))
            return true;
        task.source = source;
        // It may be given options of its own, which are not known here (--build-options).
        if (is_oclgrind(device_.description))
            return false;
        std::optional<NeededSource> needed = needed_source(source.text, source.options);
        if (!needed)
            return false;
        task.source.text = std::move(needed->text);
        task.source.options = std::move(needed->options);
        if (whole_key.empty())
            return false;
        task.key = needed_key(device, task.source.options, needed->meaning);
        device_.store.put_alias(whole_key, task.key);
        return take_entry(task);
    }

    bool take_entry(const Task &task) {
        const std::optional<ProgramImage> image = device_.store.find(task.key);
        // One that is not taken, for want of memory or of room on a disk, may be whole: what is compiled replaces it.
        return image && take_image(task, *image, 0);
    }

    void compile(std::vector<Task> &missing) {
        if (missing.empty())
            return;
        const bool in_processes = device_.store.is_on() && is_pocl_cpu(device_.description);
        if (in_processes)
            missing = compile_elsewhere(missing);
        // PoCL gives code for the launches to come only where a variable was set before it began: here it is not kept.
        compile_here(missing, device_.store.is_on() && !in_processes);
        device_.store.trim();
    }

    /// Returns what could not be compiled there.
    std::vector<Task> compile_elsewhere(const std::vector<Task> &tasks) {
        std::vector<CompileJob> jobs;
        for (const Task &task : tasks)
            jobs.push_back({device_.description, task.source});
        std::vector<Task> left;
        compile_workers(device_)->compile(
            jobs, work_group_size_, device_.host_threads, [&](std::size_t i, const CompileAnswer &answer) {
                if (answer.kind == CompileAnswer::Kind::does_not_compile)
                    throw Error(ExitCode::device, answer.content);
                if (answer.kind == CompileAnswer::Kind::no_code || !take_answer(tasks[i], answer))
                    left.push_back(tasks[i]);
            });
        return left;
    }

    bool take_answer(const Task &task, const CompileAnswer &answer) {
        ProgramImage image;
        try {
            image = program_image(answer.content);
        } catch (const std::runtime_error &) {
            return false;
        }
        if (!take_image(task, image, answer.seconds))
            return false;
        ++device_.compiled;
        device_.store.put(task.key, image);
        return true;
    }

    void compile_here(const std::vector<Task> &tasks, bool keep) {
        std::atomic<std::size_t> next{0};
        std::exception_ptr failure;
        const auto work = [&] {
            for (std::size_t i = next++; i < tasks.size(); i = next++) {
                try {
                    const auto start = Clock::now();
                    BuiltProgram program = compiler_call(device_, "compiling " + tasks[i].source.name, [&] {
                        return build_source(device_.context, device_.device, tasks[i].source);
                    });
                    if (keep)
                        store(tasks[i], program);
                    finish(tasks[i], std::move(program), seconds_since(start));
                    ++device_.compiled;
                } catch (...) {
                    const std::lock_guard lock(finishing_);
                    failure = std::current_exception();
                    next = tasks.size();
                }
            }
        };
        std::vector<std::thread> threads;
        try {
            for (std::size_t i = 1; i < std::min<std::size_t>(device_.host_threads, tasks.size()); ++i)
                threads.emplace_back(work);
        } catch (const std::system_error &) {
            // Fewer do as well.
        }
        work();
        for (std::thread &thread : threads)
            thread.join();
        if (failure)
            std::rethrow_exception(failure);
    }

    void store(const Task &task, const BuiltProgram &program) const {
        try {
            device_.store.put(task.key, image_of(program));
        } catch (const cl::Error &) {
            // A device that does not give its code away compiles each time.
        }
    }

    Device::Implementation &device_;
    const std::vector<ProgramSource> &sources_;
    const std::uint32_t work_group_size_;
    const ProgramReady &ready_;
    Claims claims_;
    std::mutex finishing_;
};

} // namespace

std::shared_ptr<CompileWorkers> compile_workers(Device::Implementation &device) {
    const std::lock_guard lock(device.built.mutex);
    std::shared_ptr<CompileWorkers> workers = device.compile_workers.lock();
    if (!workers)
        device.compile_workers = workers = std::make_shared<CompileWorkers>();
    return workers;
}

void restore_code(Device::Implementation &device) {
    if (!device.store.is_on())
        return; // there is no such folder
    const std::lock_guard lock(device.restoring);
    const unsigned renewals = renewals_of_private_folder();
    if (std::exchange(device.renewals, renewals) == renewals || !is_pocl_cpu(device.description))
        return;
    const std::lock_guard programs_lock(device.built.mutex);
    for (const auto &entry : device.built.programs) {
        const std::shared_future<Shared> &program = entry.second;
        if (program.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
            continue; // who makes it unpacks it
        try {
            compiler_call(device, "unpacking code", [&] {
                const BuiltProgram &built = *program.get();
                if (const std::optional<ProgramImage> image = device.store.find(built.key))
                    device.restored.push_back(load_image(device.context, device.device, *image, built.options).program);
            });
        } catch (const Error &) {
            // It is as it was before.
        }
    }
}

std::vector<Shared> obtain_programs(Device::Implementation &device, const std::vector<ProgramSource> &sources,
                                    std::uint32_t work_group_size, const ProgramReady &ready) {
    restore_code(device); // what is compiled goes there, too
    return Builder(device, sources, work_group_size, ready).build();
}

} // namespace gradus
