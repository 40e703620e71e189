// Messages of any length over a socket between two processes of one machine.
#pragma once

#include <string>
#include <string_view>

namespace gradus {

/// False where the other side is gone.
bool send_message(int socket, std::string_view message);

/// False where the other side is gone before the message was whole.
bool receive_message(int socket, std::string &message);

} // namespace gradus
