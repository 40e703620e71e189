// The folders in which programs are kept and compiled.
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

namespace gradus {

/// Where compiled programs are kept: $GRADUS_CACHE_DIR, else gradus/programs in user_cache_folder(). Empty where
/// GRADUS_CACHE_DIR is empty or "off", or where there is no home.
std::filesystem::path program_cache_folder();

/// The first of the folders where there is enough room, which is 1 or more; else that with the most. Empty where none
/// has any.
std::filesystem::path folder_with_room(const std::vector<std::filesystem::path> &folders,
                                       const std::function<double(const std::filesystem::path &)> &room);

/// A folder that only this process uses, deleted when it ends; made at the first call. Empty where none can be made.
/// What processes that were killed left behind goes when the next one makes its own.
std::filesystem::path private_folder();

/// Makes that folder again, empty, where somebody deleted it, as systemd does with all that a user has in /dev/shm when
/// his last session ends (RemoveIPC), renders under nohup or not. Returns how often that was so.
unsigned renewals_of_private_folder();

} // namespace gradus
