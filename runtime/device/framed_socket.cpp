#include "runtime/device/framed_socket.h"

#include <sys/socket.h>

#include <cerrno>
#include <cstdint>

namespace gradus {

namespace {

/// Longer ones are not ours.
constexpr std::uint64_t longest_message = std::uint64_t(1) << 30;

bool send_all(int socket, const char *bytes, std::size_t count) {
    while (count > 0) {
        const ssize_t sent = send(socket, bytes, count, MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR)
            continue;
        if (sent <= 0)
            return false;
        bytes += sent;
        count -= static_cast<std::size_t>(sent);
    }
    return true;
}

bool receive_all(int socket, char *bytes, std::size_t count) {
    while (count > 0) {
        const ssize_t received = recv(socket, bytes, count, 0);
        if (received < 0 && errno == EINTR)
            continue;
        if (received <= 0)
            return false;
        bytes += received;
        count -= static_cast<std::size_t>(received);
    }
    return true;
}

} // namespace

bool send_message(int socket, std::string_view message) {
    const std::uint64_t length = message.size();
    return send_all(socket, reinterpret_cast<const char *>(&length), sizeof length) &&
           send_all(socket, message.data(), message.size());
}

bool receive_message(int socket, std::string &message) {
    std::uint64_t length = 0;
    if (!receive_all(socket, reinterpret_cast<char *>(&length), sizeof length) || length > longest_message)
        return false;
    message.resize(length);
    return receive_all(socket, message.data(), length);
}

} // namespace gradus
