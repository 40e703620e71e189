// gradus-shared-compile: in the place of gradus-compile ($GRADUS_COMPILE), it hands the socket of who started it to a
// server, whose compilers all tests share: a compiler takes about as long to start as to compile a kernel, and each
// test is a process. The server is this program too; the first that finds none becomes it. It ends when nobody has used
// it for GRADUS_SHARED_COMPILE_SECONDS, else 10.
#include "runtime/device/byte_text.h"
#include "runtime/device/compile_job.h"
#include "runtime/device/compile_workers.h"
#include "runtime/device/framed_socket.h"
#include "runtime/device/hash.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace gradus {
namespace {

/// Compilers that have made so many programs are replaced, for what the compiler never frees.
constexpr unsigned longest_service = 200;

/// Not a file, so that nothing is left of a server that was killed. Servers of other builds, users and environments
/// have other names.
sockaddr_un address(socklen_t &size) {
    std::vector<std::string> variables;
    for (char **variable = environ; *variable; ++variable) {
        const std::string text = *variable;
        const bool is_of_caller = text.starts_with("POCL_CACHE_DIR=") ||
                                  text.starts_with("POCL_BINARY_SPECIALIZE_WG=") ||
                                  text.starts_with("GRADUS_CACHE_DIR=");
        for (const char *start : {"POCL_", "GRADUS_", "LD_", "OCL_", "OPENCL_", "ASAN_", "UBSAN_"})
            if (text.starts_with(start) && !is_of_caller)
                variables.push_back(text);
    }
    std::sort(variables.begin(), variables.end());
    ByteWriter writer;
    for (const std::string &variable : variables)
        writer.text(variable);
    struct stat program = {};
    stat(compile_worker_program().c_str(), &program);
    for (const auto number : {std::uint64_t(program.st_dev), std::uint64_t(program.st_ino),
                              std::uint64_t(program.st_mtim.tv_sec), std::uint64_t(getuid())})
        writer.number(number);
    const std::string name = "gradus-compilers-" + hexadecimal(hash128(writer.bytes()));
    sockaddr_un address = {};
    address.sun_family = AF_UNIX;
    std::copy(name.begin(), name.end(), address.sun_path + 1);
    size = socklen_t(offsetof(sockaddr_un, sun_path) + 1 + name.size());
    return address;
}

bool is_of_this_user(int socket) {
    ucred peer = {};
    socklen_t size = sizeof peer;
    return getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 && peer.uid == getuid();
}

/// A message of one character with a file descriptor.
struct DescriptorMessage {
    DescriptorMessage() {
        message.msg_iov = &content;
        message.msg_iovlen = 1;
        message.msg_control = space;
        message.msg_controllen = sizeof space;
    }
    DescriptorMessage(const DescriptorMessage &) = delete;
    DescriptorMessage &operator=(const DescriptorMessage &) = delete;

    msghdr message = {};

  private:
    char byte = 0;
    alignas(cmsghdr) char space[CMSG_SPACE(sizeof(int))] = {};
    iovec content = {&byte, 1};
};

bool send_descriptor(int socket, int descriptor) {
    DescriptorMessage sent;
    cmsghdr *head = CMSG_FIRSTHDR(&sent.message);
    head->cmsg_level = SOL_SOCKET;
    head->cmsg_type = SCM_RIGHTS;
    head->cmsg_len = CMSG_LEN(sizeof descriptor);
    std::memcpy(CMSG_DATA(head), &descriptor, sizeof descriptor);
    return sendmsg(socket, &sent.message, MSG_NOSIGNAL) == 1;
}

int received_descriptor(int socket) {
    int descriptor = -1;
    DescriptorMessage received;
    if (recvmsg(socket, &received.message, MSG_CMSG_CLOEXEC) != 1)
        return -1;
    const cmsghdr *head = CMSG_FIRSTHDR(&received.message);
    if (head && head->cmsg_level == SOL_SOCKET && head->cmsg_type == SCM_RIGHTS)
        std::memcpy(&descriptor, CMSG_DATA(head), sizeof descriptor);
    return descriptor;
}

/// A process that started this program, and the process of this program that it started.
struct Client {
    int jobs = -1, starter = -1;
    std::uint32_t work_group_size = 0;
    bool waits = false; ///< for an answer
    bool is_gone = false;
    std::string message;
};

class Server {
  public:
    explicit Server(int listening) : listening_(listening) {
        if (pipe2(wake_, O_CLOEXEC) != 0)
            std::exit(1);
        // Threads that stay: a compiler ends with the thread that started it.
        for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i)
            threads_.emplace_back([this] { work(); });
    }
    ~Server() {
        {
            const std::lock_guard lock(mutex_);
            ends_ = true;
        }
        changed_.notify_all();
        for (std::thread &thread : threads_)
            thread.join();
    }
    Server(const Server &) = delete;
    Server &operator=(const Server &) = delete;

    void serve(int idle_seconds) {
        for (;;) {
            std::vector<pollfd> sockets = {{listening_, POLLIN, 0}, {wake_[0], POLLIN, 0}};
            std::vector<Client *> polled;
            {
                const std::lock_guard lock(mutex_);
                clients_.remove_if([](const Client &client) {
                    if (!client.is_gone || client.waits)
                        return false;
                    close(client.jobs);
                    close(client.starter);
                    return true;
                });
                for (Client &client : clients_)
                    if (!client.waits) {
                        sockets.push_back({client.jobs, POLLIN, 0});
                        polled.push_back(&client);
                    }
            }
            const bool is_idle = clients_.empty();
            if (poll(sockets.data(), sockets.size(), is_idle ? 1000 * idle_seconds : -1) == 0 && is_idle)
                return;
            char ignored[64];
            if (sockets[1].revents != 0 && read(wake_[0], ignored, sizeof ignored) < 0)
                return;
            for (std::size_t i = 0; i < polled.size(); ++i)
                if (sockets[i + 2].revents != 0)
                    take_job(*polled[i]);
            if (sockets[0].revents != 0)
                accept_client();
        }
    }

  private:
    void accept_client() {
        Client client;
        client.starter = accept4(listening_, nullptr, nullptr, SOCK_CLOEXEC);
        if (client.starter < 0)
            return;
        const timeval limit = {5, 0};
        setsockopt(client.starter, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
        std::string size;
        const char taken = 1;
        if (is_of_this_user(client.starter) && receive_message(client.starter, size) &&
            (client.jobs = received_descriptor(client.starter)) >= 0 &&
            send(client.starter, &taken, 1, MSG_NOSIGNAL) == 1) {
            const timeval longest = {120, 0}; // one that does not read its answer
            setsockopt(client.jobs, SOL_SOCKET, SO_SNDTIMEO, &longest, sizeof longest);
            client.work_group_size = std::uint32_t(std::strtoul(size.c_str(), nullptr, 10));
            const std::lock_guard lock(mutex_);
            clients_.push_back(client);
            return;
        }
        close(client.starter);
        if (client.jobs >= 0)
            close(client.jobs);
    }

    void take_job(Client &client) {
        if (!receive_message(client.jobs, client.message)) {
            client.is_gone = true;
            return;
        }
        const std::lock_guard lock(mutex_);
        client.waits = true;
        waiting_.push_back(&client);
        changed_.notify_one();
    }

    std::shared_ptr<CompileWorkers> workers(std::uint32_t work_group_size) {
        if (!workers_ || work_group_size != work_group_size_ || ++compiled_ > longest_service) {
            workers_ = std::make_shared<CompileWorkers>();
            work_group_size_ = work_group_size;
            compiled_ = 0;
        }
        return workers_;
    }

    void work() {
        for (;;) {
            Client *client = nullptr;
            std::shared_ptr<CompileWorkers> compilers;
            {
                std::unique_lock lock(mutex_);
                changed_.wait(lock, [&] { return ends_ || !waiting_.empty(); });
                if (ends_)
                    return;
                client = waiting_.front();
                waiting_.pop_front();
                compilers = workers(client->work_group_size);
            }
            CompileAnswer answer;
            try {
                compilers->compile({compile_job(client->message)}, client->work_group_size, 1,
                                   [&](std::size_t, const CompileAnswer &given) { answer = given; });
            } catch (const std::runtime_error &error) {
                answer.content = error.what();
            }
            compilers.reset();
            const bool is_sent = send_message(client->jobs, to_bytes(answer));
            const std::lock_guard lock(mutex_);
            client->is_gone = !is_sent;
            client->waits = false;
            const char byte = 0;
            if (write(wake_[1], &byte, 1) != 1)
                client->is_gone = true;
        }
    }

    const int listening_;
    int wake_[2] = {-1, -1};
    std::vector<std::thread> threads_;
    std::mutex mutex_; ///< of all that follows
    std::condition_variable changed_;
    bool ends_ = false;
    std::list<Client> clients_;
    std::deque<Client *> waiting_;
    std::shared_ptr<CompileWorkers> workers_;
    std::uint32_t work_group_size_ = 0;
    unsigned compiled_ = 0;
};

/// Never returns in the server.
void start_server(int listening) {
    if (fork() != 0)
        return;
    setsid();
    // Who started the first client waits for the end of its output, which is not to be that of the server.
    const int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
    for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        dup2(nowhere, standard);
    for (int other = STDERR_FILENO + 1; other < 1024; ++other)
        if (other != listening)
            close(other);
    const char *chosen = std::getenv("GRADUS_SHARED_COMPILE_SECONDS");
    Server(listening).serve(chosen ? std::max(1, std::atoi(chosen)) : 10);
    std::exit(0);
}

/// A socket of the server that has taken the jobs; -1 where none does.
int hand_over(int jobs) {
    socklen_t size = 0;
    const sockaddr_un server = address(size);
    const auto *name = reinterpret_cast<const sockaddr *>(&server);
    const char *chosen = std::getenv("POCL_BINARY_SPECIALIZE_WG");
    for (int attempt = 0; attempt < 50; ++attempt) {
        const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
        char taken = 0;
        if (connect(socket, name, size) == 0 && is_of_this_user(socket) && send_message(socket, chosen ? chosen : "") &&
            send_descriptor(socket, jobs) && recv(socket, &taken, 1, 0) == 1)
            return socket;
        close(socket);
        const int listening = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
        if (bind(listening, name, size) == 0 && listen(listening, 64) == 0)
            start_server(listening);
        else
            usleep(20000); // another one is about to listen, or to end
        close(listening);
    }
    return -1;
}

} // namespace
} // namespace gradus

int main() {
    // The server's compilers are the real ones.
    unsetenv("GRADUS_COMPILE");
    const int server = gradus::hand_over(STDIN_FILENO);
    if (server < 0) {
        const std::string program = gradus::compile_worker_program();
        execl(program.c_str(), program.c_str(), nullptr);
        return 1;
    }
    // Who started this sees the server's end where the server alone has the other side of the socket.
    close(STDIN_FILENO);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    char ignored = 0;
    while (recv(server, &ignored, 1, 0) > 0) {
    }
    return 0;
}
